"""A tip on an arm with dead time, before an elastic part; with a stream and a guard, no process."""

import asyncio
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.cell.contact_motion.settings import ContactSettings
from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.cell.contact_motion.ticks import ContactTick, TickObserver
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.geometry.pose import turn_matrix
from cellctl.guard.report import GuardSamples, GuardTrip, TareResult, TripReason
from cellctl.interfaces.streaming_robot import PoseStream, StreamLimits, StreamReport
from tests.unit.cell.guard import TinyGuard

Array = NDArray[np.float64]
Part = Callable[[Array], Array]
"""Gives the wrench on the peg for six numbers of the tip, both in the axes of the task."""

SAMPLE_S = 1e-3
LIMITS = StreamLimits(step_m=2e-4, step_rad=2e-3, travel_m=0.1, travel_rad=0.5, loss_s=0.1)
FRAMES = ContactFrames(
    # A task that looks down and is turned by 170 degrees: nothing may depend on a small attitude.
    RigidTransform.from_components([0.8, 0.1, 0.4], Rotation.from_euler("XZ", [180, 170], True)),
    RigidTransform.from_components([0.01, 0.0, 0.25], Rotation.from_euler("Z", 30, True)),
    Rotation.from_euler("Z", 170, degrees=True),
)

_TASK_R_NOMINAL = FRAMES.task_R_nominal.as_matrix()


def wall(stiffness_n_m: float) -> Part:
    """A face at z = 0 that reaches everywhere."""

    def felt(tip: Array) -> Array:
        return np.array([0.0, 0.0, -stiffness_n_m * max(tip[2], 0.0), 0.0, 0.0, 0.0])

    return felt


@dataclass(eq=False)
class Hole:
    """A bore with a chamfer of 45 degrees, without friction; the peg is upright."""

    stiffness_n_m: float
    centre_m: Array = field(default_factory=lambda: np.zeros(2))
    clearance_m: float = 0.1e-3
    chamfer_m: float = 0.5e-3
    depth_m: float = 3e-3

    def __call__(self, tip: Array) -> Array:
        felt = np.zeros(6)
        offset, depth_m = tip[:2] - self.centre_m, float(tip[2])
        radius_m = float(np.hypot(*offset))
        outwards = offset / max(radius_m, 1e-12)
        beyond_m = radius_m - self.clearance_m
        if depth_m > 0 and beyond_m > self.chamfer_m:
            felt[2] -= self.stiffness_n_m * depth_m
        elif depth_m > 0 and beyond_m > 0:
            on_chamfer_m = (depth_m - (self.chamfer_m - beyond_m)) / np.sqrt(2)
            if beyond_m < on_chamfer_m:
                felt[:2] -= self.stiffness_n_m * beyond_m * outwards
            elif on_chamfer_m > 0:
                push_n = self.stiffness_n_m * on_chamfer_m / np.sqrt(2)
                felt[:2] -= push_n * outwards
                felt[2] -= push_n
        felt[2] -= self.stiffness_n_m * max(depth_m - self.depth_m, 0.0)
        return felt


@dataclass(eq=False)
class ElasticWorld:
    """The truth: the arm follows setpoints ``delay_ticks`` later with a lag of ``lag_s``."""

    part: Part
    period_s: float = 4e-3
    delay_ticks: int = 2
    lag_s: float = 5e-3
    sigma_n: float = 0.0
    sigma_n_m: float = 0.0
    now_s: float = 100.0
    sent: list[Array] = field(default_factory=list)
    forces: list[Array] = field(default_factory=list)
    """True wrench at every tick."""
    silent_from_s: float = np.inf
    """The sensor sends nothing after this time."""
    late_ticks: dict[int, float] = field(default_factory=dict)
    """Periods that a tick takes instead of one, by the number of the tick."""
    trip_above_n: float = np.inf
    watches: bool = False
    """Whether the guard trips at the limits that it was armed with, too; it filters nothing."""
    tip: Array = field(default_factory=lambda: np.array([0.0, 0.0, -1e-3, 0.0, 0.0, 0.0]))

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(5)
        self._waiting = [self.tip.copy()] * self.delay_ticks
        self.guard = WorldGuard(self)
        self.stream = WorldStream(self)
        for _ in range(50):
            self.advance(1e-3, self.tip)

    def tick(self, tip: Array) -> float:
        """Take a setpoint; the time that the tick took."""
        self.sent.append(tip)
        self._waiting.append(tip)
        periods = self.late_ticks.get(len(self.sent), 1.0)
        # The controller counts its own ticks: in a late one it stands at the last setpoint.
        self.advance(periods * self.period_s, self._waiting.pop(0))
        self.forces.append(self.part(self.tip))
        return periods * self.period_s

    def advance(self, duration_s: float, target: Array) -> None:
        steps = max(1, round(duration_s / SAMPLE_S))
        for _ in range(steps):
            self.now_s += duration_s / steps
            share = 1.0 - np.exp(-duration_s / steps / self.lag_s)
            self.tip = self.tip + share * (target - self.tip)
            if self.now_s < self.silent_from_s:
                self.guard.publish(self.now_s, self.part(self.tip))

    @property
    def dead_time_s(self) -> float:
        """θ, with a filter of 2 ms."""
        return self.period_s * (self.delay_ticks + 1.5) + self.lag_s + 2e-3


class WorldGuard(TinyGuard):
    """Gives what the part exerts, in the axes of the tip, with noise."""

    def __init__(self, world: ElasticWorld) -> None:
        super().__init__()
        self._world, self._rng = world, np.random.default_rng(6)
        self._sigma = np.repeat([world.sigma_n, world.sigma_n_m], 3)
        self._times: list[float] = []
        self._wrenches: list[Array] = []

    def publish(self, time_s: float, wrench: Array) -> None:
        # Rows times a matrix: the inverse rotation.
        felt = wrench.reshape(2, 3)
        if self._world.tip[3:].any():
            felt = felt @ turn_matrix(self._world.tip[3:])
        self._times.append(time_s)
        self._wrenches.append(
            np.ravel(felt @ _TASK_R_NOMINAL) + self._rng.normal(0.0, 1.0, 6) * self._sigma
        )
        if self.trip is None and np.abs(wrench[:3]).max() > self._greatest_n:
            self.trip = GuardTrip(TripReason.FILTERED_LIMIT, time_s, "force above its limit")

    @property
    def _greatest_n(self) -> float:
        watching = self._world.watches and self.armed
        return min(self._world.trip_above_n, self.limits[-1].filtered[0] if watching else np.inf)

    def samples(self, since_s: float) -> GuardSamples:
        first = bisect_right(self._times, since_s)
        wrench = np.array(self._wrenches[first:]).reshape(-1, 6)
        count = len(wrench)
        return GuardSamples(
            np.array(self._times[first:]), wrench, wrench.copy(), np.zeros(count), overrun=False
        )


class WorldStream(PoseStream):
    """Setpoints go to the world; its clock is the only one."""

    def __init__(self, world: ElasticWorld) -> None:
        self.period_s, self.limits = world.period_s, LIMITS
        self._world = world
        self._tick = 1
        self._sent_s = world.now_s

    @property
    def report(self) -> StreamReport:
        world = self._world
        flange = FRAMES.base_T_flange(world.tip)
        return StreamReport(world.now_s, self._tick, flange, 0, 0, self._sent_s)

    async def advance(self, base_T_flange: RigidTransform) -> StreamReport:
        # A tick is awaited on the wire, too, and others get their turn.
        await asyncio.sleep(0)
        self._sent_s = self._world.now_s
        self._world.tick(FRAMES.tip(base_T_flange))
        self._tick += 1
        return self.report


class Ticks(TickObserver):
    """Keeps them all."""

    def __init__(self) -> None:
        self.all: list[ContactTick] = []

    def take(self, tick: ContactTick) -> None:
        self.all.append(tick)


def contact_loop(
    world: ElasticWorld, figures: LoopFigures | None = None, ticks: Ticks | None = None
) -> ContactLoop:
    """The loop of a world, with gains for a stiffness of 1e6 N/m unless told otherwise."""
    settings = ContactSettings(
        figures or LoopFigures(1e6, world.dead_time_s),
        lever_m=3e-3,
        press_n=8.0,
        limit_n=50.0,
        limit_n_m=2.0,
    )
    tare = TareResult(np.zeros(6), np.full(6, world.sigma_n), 500)
    return ContactLoop(
        world.stream,
        world.guard,
        tare,
        FRAMES,
        settings=settings,
        observer=ticks or Ticks(),
        clock=lambda: world.now_s,
    )


def contact(
    world: ElasticWorld, figures: LoopFigures | None = None, ticks: Ticks | None = None
) -> StreamedContact:
    """Motions in a world, as ``contact_loop``."""
    return StreamedContact(contact_loop(world, figures, ticks))
