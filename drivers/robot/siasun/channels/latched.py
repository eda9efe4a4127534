"""What a report says of a stop that is latched, together with the driver's own latch."""

from dataclasses import replace

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError
from cellctl.interfaces.robot import RobotState

_BY_ITSELF = "the controller has latched a stop for which this driver has not asked"


def latched(state: RobotState, latch: CellError | None, why: str, *, running: bool) -> RobotState:
    """The report as whoever asks for readiness must see it: this driver would refuse a move, too.

    ``latch`` is that of the driver, ``why`` what it knows of one that only the controller has. A
    motion that is ``running`` tells its own end.
    """
    if latch is None and not state.stop_latched:
        return state
    unasked = ""
    if latch is None:
        unasked = why or _BY_ITSELF
    elif isinstance(latch, LinkError):
        unasked = str(latch)
    return replace(state, stop_latched=True, unasked_latch="" if running else unasked)
