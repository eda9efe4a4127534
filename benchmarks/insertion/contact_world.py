"""A cell without its wires: the fake's peg and hole, a stream with delay, a sensor, a guard.

What is the same as on the wire: draws of part and hole, the contact model, the law of the streamed
contact with everything above it. What is simpler: one delay and one lag stand for controller and
line, no links, no store, no second process. Time is the world's own, so a busy PC changes nothing.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.insertion.contact_guard import (
    STEP_S,
    TARE_STEPS,
    InsertionGuard,
    SensorFault,
    SensorNoise,
)
from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.errors.robot import TargetOutOfBounds
from cellctl.geometry.pose import Array
from cellctl.guard.report import TareResult
from cellctl.interfaces.streaming_robot import PoseStream, StreamLimits, StreamReport
from fakes.scenes.socket.part import PegPart, nominal_fit
from fakes.scenes.socket.peaks import ForcePeaks
from fakes.scenes.socket.scenario import CompliantArm, SocketScenario
from fakes.world.frames import inverse_matrix
from fakes.world.peg.attitude import pose_of
from fakes.world.peg.fit import Fit
from fakes.world.peg.held_peg import HeldPeg

PERIOD_S, DELAY_TICKS, LAG_S = 8e-3, 1, 5e-3
"""Timing of the stream."""
DEAD_TIME_S = 27e-3
"""That of the stream with the filter of 2 ms, as on the wire."""
LIMITS = StreamLimits(
    step_m=1e-4, step_rad=math.radians(0.05), travel_m=0.06, travel_rad=0.262, loss_s=0.2
)
"""Those of the shipped cells. A longer step is refused there, and here, too."""
_WANDER_LENGTH_M = 5e-3
_LATE_SHARE, _LATE_PERIODS = 2e-3, 2
"""Ticks whose setpoint comes a period too late: the arm stands still for it."""
_STEPS = round(PERIOD_S / STEP_S)
_WAY_LEFT = np.exp(-STEP_S / LAG_S * np.arange(1, _LATE_PERIODS * _STEPS + 1))[:, None, None]
"""Share of the way to a setpoint that is left after each step."""
_SAME_BORE_M = 0.05e-3
"""A hole whose radius differs by more is another one."""


def robot_stiffness(arm: CompliantArm) -> Array:
    """Shape (6, 6), between commanded pose and tip, in the axes of the hole."""
    turning, lateral = arm.turning_nm_rad, arm.lateral_n_m
    return np.diag([lateral, lateral, arm.axial_n_m, turning, turning, arm.yaw_nm_rad])


@dataclass(frozen=True, slots=True, eq=False)
class Imperfections:
    """Imperfections of arm and sensor, as standard deviations."""

    repeatability_m: float
    height_m: float
    force_n: float
    moment_n_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Injected:
    """What is wrong with one peg, hole, gripper or sensor; None is as drawn."""

    fit: Fit | None = None
    grip_n: float | None = None
    sensor: SensorFault | None = None
    slip_stop_m: float | None = None
    """Way after which a slipping part meets a stop in the fingers; None without one."""


class ContactWorld:
    """The truth, a millisecond at a time; stream and guard are views of it."""

    def __init__(
        self,
        scenario: SocketScenario,
        part: PegPart,
        base_T_flange: RigidTransform,
        imperfections: Imperfections,
        rng: np.random.Generator,
        *,
        injected: Injected | None = None,
    ) -> None:
        """``base_T_flange``: where the arm stands when the stream begins; the base is the cell."""
        self.now_s = 100.0
        made = injected or Injected()
        self._drawn = nominal_fit(scenario.fit)
        self.fit: Fit = made.fit or self._drawn
        self._hole = part.cell_T_hole.as_matrix()
        self._hole_inverse = inverse_matrix(self._hole)
        self._flange_T_peg = part.flange_T_peg.as_matrix()
        self.flange = base_T_flange.as_matrix()
        self._waiting = [self.flange] * DELAY_TICKS
        self._imperfections, self._rng = imperfections, rng
        self._error_m = np.zeros(3)
        self._slip_stop_m = made.slip_stop_m or np.inf
        stiffness = robot_stiffness(scenario.compliance)
        grip_n = made.grip_n or scenario.peg.grip_force_n
        begins = pose_of(self._hole_inverse @ self.flange @ self._flange_T_peg)
        self.peg = HeldPeg(self.fit, stiffness, begins, grip_n=grip_n)
        self.peaks = ForcePeaks()
        self.late = 0
        self.stream = InsertionStream(self)
        noise = SensorNoise(imperfections.force_n, imperfections.moment_n_m, rng)
        self.guard = InsertionGuard(noise, made.sensor)

    @property
    def seated(self) -> bool:
        """True for a peg within 0.3 mm of the drawn seat, in the mouth of a hole as drawn."""
        x, y, z, *_ = self.peg.pose
        within = np.hypot(x, y) < self._drawn.mouth_radius_m
        same = abs(self.fit.bore_radius_m - self._drawn.bore_radius_m) < _SAME_BORE_M
        return bool(same and within and abs(z + self._drawn.depth_m) < 0.3e-3)

    def tick(self, target: Array) -> None:
        """One period of the stream, or two where the setpoint came too late."""
        late = self._rng.random() < _LATE_SHARE
        self.late += late
        self._waiting.append(target)
        self._wander(target)
        target = self._waiting.pop(0)
        steps = _STEPS * _LATE_PERIODS if late else _STEPS
        # Steps of one tick are so small that blended matrices stay rotations.
        flanges = target + _WAY_LEFT[:steps] * (self.flange - target)
        self.flange = flanges[-1]
        held = self._hole_inverse @ flanges @ self._flange_T_peg
        held[:, :3, 3] += self._error_m
        wrenches, tips_m, times_s = np.empty((steps, 6)), np.empty((steps, 3)), []
        for step in range(steps):
            self.peg.follow(pose_of(held[step]), STEP_S)
            if self.peg.slip_m >= self._slip_stop_m:
                self.peg.hold_with(np.inf)
                self._slip_stop_m = np.inf
            wrenches[step], tips_m[step] = self.peg.wrench, self.peg.pose[:3]
            self.now_s += STEP_S
            times_s.append(self.now_s)
        self.peaks.take(wrenches)
        self.guard.publish(times_s, flanges, self._about_base(wrenches, tips_m))

    def tare(self, frames: ContactFrames) -> TareResult:
        """Stand for as long as a tare takes, and give forces about the tip of these frames."""
        tare = self.guard.give_in(frames)
        times_s = []
        for _ in range(TARE_STEPS):
            self.now_s += STEP_S
            times_s.append(self.now_s)
        flanges = np.broadcast_to(self.flange, (TARE_STEPS, 4, 4))
        self.guard.publish(times_s, flanges, np.zeros((TARE_STEPS, 6)))
        return tare

    def _about_base(self, wrenches: Array, tips_m: Array) -> Array:
        """Wrenches about the true tip, in the axes of the hole, about the origin of the base and in
        its axes; one row for each step."""
        if not wrenches.any():
            return wrenches
        turn = self._hole[:3, :3]
        force, moment = wrenches[:, :3] @ turn.T, wrenches[:, 3:] @ turn.T
        return np.hstack([force, moment + np.cross(tips_m @ turn.T + self._hole[:3, 3], force)])

    def _wander(self, target: Array) -> None:
        """The arm is not quite where its encoders say; the error changes with the way."""
        way_m = float(np.linalg.norm(target[:3, 3] - self.flange[:3, 3]))
        keep = np.exp(-way_m / _WANDER_LENGTH_M)
        one = self._imperfections
        sigma_m = np.array([one.repeatability_m, one.repeatability_m, one.height_m])
        fresh = np.sqrt(1.0 - keep**2) * sigma_m * self._rng.normal(0.0, 1.0, 3)
        self._error_m = keep * self._error_m + fresh


class InsertionStream(PoseStream):
    """Setpoints go to the world."""

    def __init__(self, world: ContactWorld) -> None:
        self.period_s, self.limits = PERIOD_S, LIMITS
        self._world, self._tick, self._sent_s = world, 1, world.now_s
        self._last = world.flange

    @property
    def report(self) -> StreamReport:
        """Where the arm is by its encoders."""
        world = self._world
        flange = RigidTransform(_orthonormal(world.flange), normalize=False, copy=False)
        return StreamReport(world.now_s, self._tick, flange, world.late, world.late, self._sent_s)

    async def advance(self, base_T_flange: RigidTransform) -> StreamReport:
        """See ``PoseStream``."""
        self._sent_s = self._world.now_s
        target = base_T_flange.as_matrix()
        _require_step(target, self._last)
        self._last = target
        self._world.tick(target)
        self._tick += 1
        return self.report


def _require_step(target: Array, last: Array) -> None:
    step_m = float(np.linalg.norm(target[:3, 3] - last[:3, 3]))
    # Two rotations that differ by a small angle have matrices that differ by its root of two.
    step_rad = float(np.linalg.norm(target[:3, :3] - last[:3, :3])) / math.sqrt(2.0)
    if not (step_m <= LIMITS.step_m + 1e-9 and step_rad <= LIMITS.step_rad + 1e-9):
        raise TargetOutOfBounds(f"streamed step of {step_m * 1e3:.4f} mm and {step_rad:.6f} rad")


def _orthonormal(pose: Array) -> Array:
    """The pose whose axes are square again after a blend: a step of Newton's method, which leaves
    the square of an error that is 1e-9 for the turns of a tick."""
    made = pose.copy()
    axes = pose[:3, :3]
    made[:3, :3] = axes @ (1.5 * np.eye(3) - 0.5 * (axes.T @ axes))
    return made
