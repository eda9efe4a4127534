"""9xx: faults of cellctl itself."""

from cellctl.errors.base import CellError


class InternalError(CellError):
    """A fault of the software."""


class Unexpected(InternalError):
    """An exception that nobody foresaw."""

    number = 901
    text = "Unexpected software fault"
    cause = "A defect in cellctl or a driver."
    remedy = "Keep the log and report it; Clear and Reset start the cell again."


class WorkerDied(InternalError):
    """A vision worker process ended."""

    number = 902
    text = "A vision worker process died"
    cause = "Out of memory, or a defect in a native library."
    remedy = "Clear starts new workers; keep the log."


class StateDidNotEnd(InternalError):
    """A cancelled state coroutine did not clean up in time."""

    number = 904
    text = "A cancelled sequence did not end in time"
    cause = "A device call hangs while it is being stopped, or a defect."
    remedy = "Use the emergency stop if anything moves; restart the daemon and keep the log."


class WorkerSilent(InternalError):
    """A vision worker process did not answer in time; all of them were ended."""

    number = 905
    text = "A vision worker process does not answer"
    cause = "The process hangs or was suspended, or the PC is overloaded."
    remedy = "Clear starts new workers. Keep the log; look for what else runs on the PC."
