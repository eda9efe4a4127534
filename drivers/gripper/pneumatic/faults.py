"""Translates what the sensors show, or do not show in time, to numbered faults of the cell."""

from cellctl.errors.gripper import (
    GripperNotClosed,
    GripperNotOpened,
    GripperSensorsDisagree,
    NoPartGripped,
    PartLost,
)
from cellctl.interfaces.gripper import GripperState


def not_opened(gripper: str, timeout_s: float, state: GripperState) -> GripperNotOpened:
    """The open end position was not reached."""
    return GripperNotOpened(f"{gripper}: after {timeout_s:g} s {_seen(state)}")


def not_closed(gripper: str, timeout_s: float, state: GripperState) -> GripperNotClosed:
    """The closed position was not reached."""
    return GripperNotClosed(f"{gripper}: after {timeout_s:g} s {_seen(state)}")


def no_part(gripper: str) -> NoPartGripped:
    """Closed on nothing."""
    return NoPartGripped(f"{gripper}: closed, and the part sensor sees nothing")


def part_lost(gripper: str, state: GripperState) -> PartLost:
    """What held a part holds it no longer."""
    return PartLost(f"{gripper}: {_seen(state)}")


def contradiction(gripper: str) -> GripperSensorsDisagree:
    """Both end positions at once."""
    return GripperSensorsDisagree(f"{gripper}: opened and closed at once")


def _seen(state: GripperState) -> str:
    jaws = "opened" if state.opened else "closed" if state.closed else "between open and closed"
    return f"jaws {jaws}, {'part' if state.part_present else 'no part'} seen"
