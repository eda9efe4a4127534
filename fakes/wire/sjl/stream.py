"""Streamed motion as a controller's job program does it (docs/protocols/sjl-1.md, section 7)."""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from fakes.wire.sjl.records import RecordError, fixed, pose_fields
from fakes.world.frames import MM, Array, matrix_distance, written_matrix
from fakes.world.robot import RefusedMotionError, RobotArm

_ROUNDING_MM, _ROUNDING_DEG = 0.0005, 0.0005
"""More than rounding to the four decimals of a record can add to the difference of two poses."""


@dataclass(frozen=True, slots=True)
class StreamLimits:
    """The figures of a STREAM command, or of the option that offers it."""

    step_mm: float
    step_deg: float
    travel_mm: float
    travel_deg: float
    loss_ms: float

    def within(self, offered: "StreamLimits") -> bool:
        """Every figure is above zero and not greater than offered."""
        pairs = (
            (self.step_mm, offered.step_mm),
            (self.step_deg, offered.step_deg),
            (self.travel_mm, offered.travel_mm),
            (self.travel_deg, offered.travel_deg),
            (self.loss_ms, offered.loss_ms),
        )
        return all(0 < asked <= allowed for asked, allowed in pairs)


@dataclass(frozen=True, slots=True)
class StreamOffer:
    """What the job program can do."""

    period_ms: int = 8
    limits: StreamLimits = field(default=StreamLimits(0.1, 0.05, 30.0, 5.0, 200))

    def option(self) -> str:
        """The field of the hello."""
        limits = self.limits
        lengths = (limits.step_mm, limits.step_deg, limits.travel_mm, limits.travel_deg)
        numbers = [fixed(value, 4) for value in lengths]
        return "STREAM=" + "/".join([str(self.period_ms), *numbers, str(round(limits.loss_ms))])


class Stream:
    """One stream from its ACK to its end. Times are those of the controller's clock."""

    def __init__(
        self, arm: RobotArm, offer: StreamOffer, limits: StreamLimits, time_s: float
    ) -> None:
        self._arm = arm
        self._limits = limits
        self._period_s = offer.period_ms / 1000
        self._tick_s = time_s
        self._due_s = time_s + self._period_s
        self._start = self._command = self._setpoint = arm.encoder_matrix(time_s)
        """base_T_flange at the beginning, where the arm was sent last, and where it is to go."""
        self._tick = 0
        self._set_number = 0
        self._fresh = False
        self._silent_ticks = self._late = self._lost = 0

    def take(self, number: int, values: list[float]) -> None:
        """A SET; raises ``RecordError``, or ``RefusedMotionError`` with the reason of the end."""
        if number > self._tick + 1:
            raise RecordError(f"setpoint {number} in tick {self._tick}")
        last_number = max(self._set_number, 1)  # the first counts from the first tick
        if number <= last_number:
            self._late += 1
            return
        # Counted and taken all the same: it is newer than what the arm has.
        self._late += number <= self._tick
        setpoint = written_matrix(values)
        # Where a setpoint was lost the next one may be as far away as both together.
        steps = number - last_number
        limits = self._limits
        if _exceeds(self._setpoint, setpoint, steps * limits.step_mm, steps * limits.step_deg):
            raise RefusedMotionError("STEP")
        if _exceeds(self._start, setpoint, limits.travel_mm, limits.travel_deg):
            raise RefusedMotionError("TRAVEL")
        self._setpoint, self._set_number, self._fresh = setpoint, number, True

    def tick(self, time_s: float) -> bool:
        """True when a tick was due and has been carried out; raises ``RefusedMotionError``."""
        if not self.coast(time_s):
            return False
        self._silent_ticks = 0 if self._fresh else self._silent_ticks + 1
        self._lost += self._tick > 1 and not self._fresh
        self._fresh = False
        if self._silent_ticks * self._period_s * 1000 > self._limits.loss_ms:
            raise RefusedMotionError("STALE")
        self._command = self._stepped()
        self._arm.follow(self._tick_s, self._command, self._period_s)
        return True

    def coast(self, time_s: float) -> bool:
        """The same, for an arm that is coming to a stop and takes no setpoint any more."""
        if time_s < self._due_s:
            return False
        # The arm is told the time at which the tick was due, so that its steps join without a gap
        # and are never run faster. A computer that was late by more than half a period lets the
        # ticks slip: a real controller is never late for its own ticks, nor hurries afterwards.
        slipped = time_s - self._due_s > self._period_s / 2
        self._tick_s = time_s if slipped else self._due_s
        self._due_s = self._tick_s + self._period_s
        self._tick += 1
        return True

    def record(self, robot_ms: float) -> list[str]:
        """TICK, with the encoders' pose of that time."""
        counts = (self._tick, round(robot_ms), self._set_number, self._late, self._lost)
        pose = pose_fields(self._arm.encoder_matrix(self._tick_s))
        return ["TICK", *(str(count) for count in counts), *pose]

    def _stepped(self) -> Array:
        """The pose one step, or less, from the last one that was sent towards the setpoint."""
        distance_m, angle_rad = matrix_distance(self._command, self._setpoint)
        ratio = min(
            1.0,
            self._limits.step_mm * MM / max(distance_m, 1e-12),
            np.deg2rad(self._limits.step_deg) / max(angle_rad, 1e-12),
        )
        if ratio == 1.0:
            return self._setpoint
        command = Rotation.from_matrix(self._command[:3, :3])
        turn = command.inv() * Rotation.from_matrix(self._setpoint[:3, :3])
        stepped: Array = self._command + ratio * (self._setpoint - self._command)
        stepped[:3, :3] = (command * Rotation.from_rotvec(ratio * turn.as_rotvec())).as_matrix()
        return stepped


def _exceeds(start: Array, end: Array, allowed_mm: float, allowed_deg: float) -> bool:
    distance_m, angle_rad = matrix_distance(start, end)
    too_far = distance_m / MM > allowed_mm + _ROUNDING_MM
    return too_far or bool(np.rad2deg(angle_rad) > allowed_deg + _ROUNDING_DEG)
