"""How long the daemon waits for devices, jobs and disk before it calls their silence a fault."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TimeLimits:
    """Seconds. Drivers and the store have shorter ones of their own; these end what hangs there."""

    ask_s: float = 60.0
    """Time for a device to say who it is; a camera may still be busy with an image before."""
    stop_s: float = 8.0
    """Time for the stops of all robots together."""
    leave_s: float = 8.0
    """Time for a cancelled job to stop its robots and write down what it has."""
    abort_s: float = 20.0
    """Time for the unit to come to rest when the daemon ends: longer than stop and leave
    together."""
    open_record_s: float = 30.0
    """Time for the disk to take the row and the files of a run; nothing has moved yet."""
    close_record_s: float = 15.0
    """Time for the disk to take the end of a run, which the line waits for."""


USUAL = TimeLimits()
