"""A position variable of the job language: a pose, joints, or both as GETP gives them.

What the controller keeps beside the numbers, frames and configuration of the arm, comes with GETP
or by teaching alone. A position that was only filled with numbers has neither, and a motion to it
would go nobody knows where; here it is an alarm. These are assumptions on the strict side, and the
installation sheet of the jobs has them verified.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from fakes.robot_jobs.lexer import JobError

POSE = ("X", "Y", "Z", "RZ", "RY", "RX")
"""Coordinates of a pose, in mm and degrees."""
JOINTS = ("J1", "J2", "J3", "J4", "J5", "J6")
"""Joint angles, in degrees."""


@dataclass(slots=True)
class Position:
    """Empty until it is got or copied. Every error is a ``JobError``: the controller's alarm."""

    _values: dict[str, float] = field(default_factory=dict)

    def get(self, values: Mapping[str, float]) -> None:
        """GETP: pose, joints, frames and configuration of where the arm is."""
        self._values = dict(values)

    def copy(self, other: "Position") -> None:
        """SET of one position to another."""
        self._values = dict(other._values)

    def set_frame(self, number: int) -> None:
        """SETP FRAME: only frame 0 is set up here, the flange and the base."""
        self._demand_taught()
        if number != 0:
            raise JobError(f"frame {number} is not set up")

    def read(self, name: str) -> float:
        """The value of a scalar."""
        if name not in self._values:
            raise JobError(f"a position has no {name}")
        return self._values[name]

    def write(self, name: str, value: float) -> None:
        """Set a scalar. Joints make it a joint position, which has no pose, and the other way
        round: the controller does not compute the one from the other."""
        self._demand_taught()
        kind = JOINTS if name in JOINTS else POSE
        if any(one not in self._values for one in kind):
            raise JobError(f"{name} is of another kind than the position")
        self._values = {one: self._values[one] for one in kind} | {name: value}

    def target(self, names: Sequence[str]) -> list[float]:
        """The values that a motion needs: ``POSE`` or ``JOINTS``."""
        return [self.read(name) for name in names]

    def _demand_taught(self) -> None:
        if not self._values:
            raise JobError("a position that was never taught has no frame and no configuration")
