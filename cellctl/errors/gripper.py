"""34x: grippers."""

from cellctl.errors.base import CellError, Reaction


class GripperError(CellError):
    """A gripper did not reach its goal, or contradicts itself."""


class GripperNotOpened(GripperError):
    """The jaws did not reach their open end position in time."""

    number = 341
    text = "Gripper did not open"
    cause = "No air pressure, valve or hose, jaws jammed, or the sensor of the open position."
    remedy = "Check pressure, jaws and sensor. Look whether the part hangs on the jaws."


class GripperNotClosed(GripperError):
    """The jaws did not close in time."""

    number = 342
    text = "Gripper did not close"
    cause = "No air pressure, valve or hose, jaws jammed, or the sensor of the closed position."
    remedy = "Check pressure, jaws and sensor. Look whether a part lies crosswise."


class NoPartGripped(GripperError):
    """The jaws have closed and there is no part between them."""

    number = 343
    text = "Gripper closed without a part"
    cause = "No part at the place, a part out of place, or the part sensor."
    remedy = "Check that the part lies where the robot closes, then start again."
    reaction = Reaction.STOP


class PartLost(GripperError):
    """A part that was gripped is no longer there."""

    number = 344
    text = "Gripper lost its part"
    cause = "Part slipped or was knocked off, air pressure fell, or the part sensor."
    remedy = "Find the part before anything moves. Check pressure and jaws, then start again."


class GripperSensorsDisagree(GripperError):
    """The gripper reports open and closed at once."""

    number = 345
    text = "Gripper's sensors contradict each other"
    cause = "A sensor is broken, out of place or wired to the wrong input."
    remedy = "Check both end positions by hand against the lamps of the inputs."
