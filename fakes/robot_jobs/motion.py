"""Motions of a job on the fake arm."""

from collections.abc import Callable

import numpy as np

from fakes.faults import FaultBoard
from fakes.robot_jobs.lexer import JobError
from fakes.robot_jobs.position import JOINTS, POSE, Position
from fakes.wire.sjl.panel import Panel
from fakes.world.frames import MM, from_written, matrix_to_written
from fakes.world.robot import RefusedMotionError, RobotArm

ACCELERATION_MAX_MM_S2 = 1000.0
"""What ``ACC = 100`` means on this controller."""
_EMERGENCY_LATENCY_S = 0.02
"""An emergency stop and drives without power act past the job, without the dead time of a stop."""


class Motions:
    """What MOVJ, MOVL and GETP do, and what the panel does to a motion."""

    def __init__(
        self, arm: RobotArm, clock: Callable[[], float], panel: Callable[[], Panel]
    ) -> None:
        self._arm, self._clock, self._panel = arm, clock, panel
        self._begun, self._begun_s = False, 0.0

    def here(self) -> dict[str, float]:
        """The encoders' pose and joints, as GETP reads them."""
        now_s = self._clock()
        pose = matrix_to_written(self._arm.encoder_matrix(now_s))
        joints = np.rad2deg(self._arm.joints(now_s)).tolist()
        return dict(zip((*POSE, *JOINTS), (*pose, *joints), strict=True))

    def begin(self, word: str, target: Position, speed: float, acceleration: float) -> None:
        """Raises ``JobError`` where the controller would show an alarm."""
        now_s = self._clock()
        faults = self._panel().faults
        self._arm.override_percent = 0 if faults.active("override_zero") else 100
        if rejected := faults.use("reject"):
            raise JobError(f"alarm of the controller: {rejected.text('reason', 'LIMIT')}")
        try:
            if word == "MOVJ":
                joints = np.deg2rad(target.target(JOINTS))
                self._arm.start_joint(now_s, joints, speed)
            else:
                pose = from_written(target.target(POSE))
                path_mm_s2 = ACCELERATION_MAX_MM_S2 * acceleration / 100
                self._arm.start_linear(now_s, pose, speed * MM, path_mm_s2 * MM)
        except RefusedMotionError as refused:
            raise JobError(f"alarm of the controller: {refused.reason}") from None
        self._begun, self._begun_s = True, now_s

    def moving(self) -> bool:
        """The arm moves."""
        return self._arm.moving(self._clock())

    @property
    def cut_short(self) -> bool:
        """The motion was braked before its target and is held there."""
        return self._begun and self._arm.cut_short

    def stop(self, *, latency_s: float | None = None) -> None:
        """Brake on the path."""
        slow = self._panel().faults.active("stop_latency")
        if latency_s is None and slow:
            latency_s = slow.number("latency_s", 0.5)
        if self.moving():
            self._arm.stop(self._clock(), latency_s=latency_s)

    def supervise(self) -> None:
        """Hold the arm where the panel does not allow it to move."""
        panel = self._panel()
        self._break_in(panel.faults)
        if panel.emergency_stop or not panel.drives:
            self.stop(latency_s=_EMERGENCY_LATENCY_S)
        elif panel.error_code or (panel.mode != "REM" and not self._arm.by_hand):
            self.stop()

    def _break_in(self, faults: FaultBoard) -> None:
        """Faults that come a while into the next motion."""
        if not self.moving() or not self._begun:
            return
        for name, what in (
            ("emergency_stop_mid_move", "emergency_stop"),
            ("abort", "vendor_error"),
        ):
            fault = faults.active(name)
            if fault and self._clock() - self._begun_s >= fault.number("after_s", 0.2):
                faults.use(name)
                faults.inject(what)
