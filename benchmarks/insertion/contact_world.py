"""A cell without its wires: the fake's peg and hole, a stream with delay, a sensor, a guard.

What is the same as on the wire: draws of part and hole, the contact model, the law of the streamed
contact with everything above it. What is simpler: one delay and one lag stand for controller and
line, no links, no store, no second process. Time is the world's own, so a busy PC changes nothing.
"""

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.geometry.pose import Array
from cellctl.guard.limits import GuardLimits, Six
from cellctl.guard.report import GuardSamples, GuardTrip, TareResult, TripReason
from cellctl.guard.watch.detectors import FrozenDetector
from cellctl.interfaces.streaming_robot import PoseStream, StreamLimits, StreamReport
from fakes.scenes.socket.part import PegPart, nominal_fit
from fakes.scenes.socket.peaks import ForcePeaks
from fakes.scenes.socket.scenario import CompliantArm, SocketScenario
from fakes.world.frames import inverse_matrix
from fakes.world.peg.attitude import pose_of
from fakes.world.peg.fit import Fit
from fakes.world.peg.held_peg import HeldPeg

STEP_S = 1e-3
PERIOD_S, DELAY_TICKS, LAG_S = 8e-3, 1, 5e-3
"""Timing of the stream; with the filter of 2 ms it has a dead time of 27 ms, as on the wire."""
LIMITS = StreamLimits(step_m=5e-4, step_rad=5e-3, travel_m=0.1, travel_rad=0.5, loss_s=0.2)
_BANDWIDTH_HZ = 200.0
_WANDER_LENGTH_M = 5e-3
_LATE_SHARE, _LATE_PERIODS = 2e-3, 2.0
"""Ticks whose setpoint comes a period too late: the arm stands still for it."""
_BLOCK = 4096
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
    moment_nm: float


class SensorFault:
    """A sensor that tells something else than what acts on it, from a moment on."""

    def __init__(self, told: Callable[[Array, Array], Array]) -> None:
        """``told``: what it tells for a true sample and for the last one before the fault."""
        self.begins_s = np.inf
        """Beginning on the clock of the world; set by whoever knows when."""
        self._told, self._last = told, np.zeros(6)

    def tell(self, sample: Array, now_s: float) -> Array:
        """What the sensor tells for one true sample, shape (6,)."""
        if now_s < self.begins_s:
            self._last = sample
            return sample
        return self._told(sample, self._last)


@dataclass(frozen=True, slots=True, eq=False)
class Injected:
    """What is wrong with one peg, hole, gripper or sensor; None is as drawn."""

    fit: Fit | None = None
    grip_n: float | None = None
    sensor: SensorFault | None = None


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
        stiffness = robot_stiffness(scenario.compliance)
        grip_n = made.grip_n or scenario.peg.grip_force_n
        self.peg = HeldPeg(self.fit, stiffness, pose_of(self._hole_T_peg()), grip_n=grip_n)
        self.peaks = ForcePeaks()
        self.late = 0
        self.stream = InsertionStream(self)
        self.guard = InsertionGuard(self, made.sensor)

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
        share = 1.0 - np.exp(-STEP_S / LAG_S)
        for _ in range(round(PERIOD_S * (_LATE_PERIODS if late else 1.0) / STEP_S)):
            self.now_s += STEP_S
            # Steps of one tick are so small that blended matrices stay rotations.
            self.flange = self.flange + share * (target - self.flange)
            self.peg.follow(pose_of(self._hole_T_peg()), STEP_S)
            wrench = self.peg.wrench
            self.peaks.take(wrench)
            self.guard.publish(wrench)

    def about(self, point: Array, wrench: Array) -> Array:
        """A wrench about the true tip, in the axes of the hole, about a point of the base and in
        its axes."""
        if not wrench.any():
            return wrench
        turn = self._hole[:3, :3]
        force = turn @ wrench[:3]
        lever = turn @ np.array(self.peg.pose[:3]) + self._hole[:3, 3] - point
        (lx, ly, lz), (fx, fy, fz) = lever.tolist(), force.tolist()
        # What np.cross computes, in a tenth of its time; this is done for every millisecond.
        moment = np.array([ly * fz - lz * fy, lz * fx - lx * fz, lx * fy - ly * fx])
        return np.concatenate([force, turn @ wrench[3:] + moment])

    def _hole_T_peg(self) -> Array:
        held = self._hole_inverse @ self.flange @ self._flange_T_peg
        held[:3, 3] += self._error_m
        return np.asarray(held)

    def _wander(self, target: Array) -> None:
        """The arm is not quite where its encoders say; the error changes with the way."""
        way_m = float(np.linalg.norm(target[:3, 3] - self.flange[:3, 3]))
        keep = np.exp(-way_m / _WANDER_LENGTH_M)
        one = self._imperfections
        sigma_m = np.array([one.repeatability_m, one.repeatability_m, one.height_m])
        fresh = np.sqrt(1.0 - keep**2) * sigma_m * self._rng.normal(0.0, 1.0, 3)
        self._error_m = keep * self._error_m + fresh

    def noise(self) -> Array:
        """Noise of a block of samples of the sensor, shape (n, 6)."""
        one = self._imperfections
        sigma = np.repeat([one.force_n, one.moment_nm], 3)
        return np.asarray(self._rng.normal(0.0, 1.0, (_BLOCK, 6)) * sigma)


class InsertionStream(PoseStream):
    """Setpoints go to the world."""

    def __init__(self, world: ContactWorld) -> None:
        self.period_s, self.limits = PERIOD_S, LIMITS
        self._world, self._tick, self._sent_s = world, 1, world.now_s

    @property
    def report(self) -> StreamReport:
        """Where the arm is by its encoders."""
        world = self._world
        flange = RigidTransform.from_matrix(world.flange)
        return StreamReport(world.now_s, self._tick, flange, world.late, world.late, self._sent_s)

    async def advance(self, base_T_flange: RigidTransform) -> StreamReport:
        """See ``PoseStream``."""
        self._sent_s = self._world.now_s
        self._world.tick(base_T_flange.as_matrix())
        self._tick += 1
        return self.report


class InsertionGuard:
    """The sensor through its bandwidth and noise, and the limits of the guard on it."""

    def __init__(self, world: ContactWorld, fault: SensorFault | None) -> None:
        self._world, self._fault = world, fault
        self._frozen: FrozenDetector | None = None
        self._trip: GuardTrip | None = None
        self._frames: ContactFrames | None = None
        self._limits: GuardLimits | None = None
        self._block, self._used = world.noise(), 0
        self._felt, self._filtered = np.zeros(6), np.zeros(6)
        self._share = 1.0 - np.exp(-STEP_S * 2 * np.pi * _BANDWIDTH_HZ)
        self._times: list[float] = []
        self._wrenches: list[Array] = []

    def give_in(self, frames: ContactFrames) -> TareResult:
        """Give forces about the tip of these frames from now on, as after a tare at standstill."""
        self._frames = frames
        self._times, self._wrenches = [], []
        for _ in range(60):
            self._world.now_s += STEP_S
            self.publish(np.zeros(6))
        return TareResult(np.zeros(6), self._block.std(axis=0), 500)

    def publish(self, wrench: Array) -> None:
        """A millisecond has passed with this wrench on the peg."""
        if self._frames is None:
            return
        if self._used == len(self._block):
            self._block, self._used = self._world.noise(), 0
        noise = self._block[self._used]
        self._used += 1
        tip = self._world.flange @ self._frames.flange_T_tip.as_matrix()
        about = self._world.about(tip[:3, 3], wrench)
        # Rows times a matrix: the inverse rotation.
        turned = np.ravel(about.reshape(2, 3) @ tip[:3, :3])
        self._felt = self._felt + self._share * (turned - self._felt)
        sample = self._felt + noise
        if self._fault is not None:
            sample = self._fault.tell(sample, self._world.now_s)
        self._times.append(self._world.now_s)
        self._wrenches.append(sample)
        self._watch(sample)

    def _watch(self, sample: Array) -> None:
        limits = self._limits
        if limits is None:
            return
        if self._frozen is not None and self._frozen.update(_six(sample)):
            frozen = GuardTrip(TripReason.SENSOR_FROZEN, self._world.now_s, "")
            self._trip = self._trip or frozen
        share = STEP_S / (limits.filter_s + STEP_S)
        self._filtered = self._filtered + share * (sample - self._filtered)
        for reason, seen, most in (
            (TripReason.FILTERED_LIMIT, self._filtered, limits.filtered),
            (TripReason.RAW_LIMIT, sample, limits.raw),
        ):
            if self._trip is None and bool((np.abs(seen) > most).any()):
                self._trip = GuardTrip(reason, self._world.now_s, f"{np.abs(seen).max():.1f}")

    @property
    def trip(self) -> GuardTrip | None:
        """The latched trip."""
        return self._trip

    def samples(self, since_s: float) -> GuardSamples:
        """See ``GuardPort``."""
        first = bisect_right(self._times, since_s)
        wrench = np.array(self._wrenches[first:]).reshape(-1, 6)
        times = np.array(self._times[first:])
        return GuardSamples(times, wrench, wrench.copy(), np.zeros(len(wrench)), overrun=False)

    async def arm(self, limits: GuardLimits) -> None:
        """Watch these limits from now on."""
        self._limits, self._frozen = limits, FrozenDetector(limits.frozen_samples)

    async def disarm(self) -> None:
        """Watch nothing."""
        self._limits = None


def _six(values: Array) -> Six:
    a, b, c, d, e, f = values.tolist()
    return a, b, c, d, e, f
