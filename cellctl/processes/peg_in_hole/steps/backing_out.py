"""What becomes of the peg where a cycle fails: drawn out, or left where it stands."""

from cellctl import log
from cellctl.cell.contact_motion.motions import ContactMotions, Ended
from cellctl.errors.base import CellError
from cellctl.errors.streamed_contact import AdmittanceSaturated, ContactLost
from cellctl.processes.peg_in_hole.faults import ByTouchError

_CLEAR_M = 10e-3
"""Over the face."""
_LEFT = "the peg is left where it stands"
_log = log.get(__name__)


async def back_out_after(fault: CellError, motions: ContactMotions) -> str:
    """Draw the peg out by the way it came, where the fault allows it; words for the operator.

    After a fault of stream, sensor or guard the arm stands: nothing says what a motion would meet.
    What fails on the way out is noted on the fault: that one says what became of the part.
    """
    if not _allows(fault):
        return _LEFT
    try:
        ended = (await motions.back_out(_CLEAR_M)).ended
    except CellError as second:
        fault.add_note(f"while the peg was drawn out: {second}")
        _log.warning("drawing out incomplete", fault=str(fault), second=str(second))
        return _LEFT
    return "something holds the peg back" if ended is Ended.FORCE else "the peg was drawn out"


def _allows(fault: CellError) -> bool:
    if isinstance(fault, ByTouchError):
        return fault.leaves_hole
    return isinstance(fault, AdmittanceSaturated | ContactLost)
