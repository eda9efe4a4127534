"""Holds the reports that follow a stop against the standstill that the controller has confirmed."""

from drivers.robot.siasun.codec.records import Six, Status

MOVED_DEG = 0.2
"""A joint that turns further under the latch is one that moves: brakes that close and reports of an
arm that stands make hundredths of a degree."""
LONGEST_S = 0.3
"""The reports may contradict the confirmation for so long: fifteen of them, and a hiccup of the job
program is none."""


class AfterStop:
    """Knows of an arm that goes on although its controller has confirmed the stop.

    An arm that is released, or whose key is not on remote, may move: somebody jogs it.
    """

    def __init__(self) -> None:
        self._confirmed = False
        self._joints_deg: Six | None = None
        """Where the first report after the confirmation has the arm."""
        self._since_s: float | None = None
        """When the reports began to contradict."""

    def confirmed(self) -> None:
        """The controller says that the arm stands."""
        self._confirmed, self._joints_deg, self._since_s = True, None, None

    def moves_on(self, status: Status, time_s: float) -> bool:
        """Whether reports, the last of which is this one, have contradicted for too long."""
        if not self._confirmed:
            return False
        if not status.latched or status.mode != "REM":
            self._confirmed = False
            return False
        if self._joints_deg is None:
            self._joints_deg = status.joints_deg
        turned = zip(status.joints_deg, self._joints_deg, strict=True)
        # Written so that an angle that is not a number counts as one that moves.
        stands = not status.moving and all(abs(now - then) <= MOVED_DEG for now, then in turned)
        self._since_s = None if stands else time_s if self._since_s is None else self._since_s
        return self._since_s is not None and time_s - self._since_s > LONGEST_S
