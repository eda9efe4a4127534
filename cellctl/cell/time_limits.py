"""How long the daemon waits for devices, jobs and disk before it calls their silence a fault."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TimeLimits:
    """Drivers and the store have shorter time-outs of their own; these end what hangs there.

    They take effect only when something is broken already, so their exact values do not matter.
    What matters is that none cuts off what is only slow, and that they nest as stated below.
    """

    ask_s: float = 60.0
    """Time for a device to say who it is; a camera may still be busy with an image before."""
    stop_s: float = 8.0
    """Time for the stops of all robots together, which run at the same time. A driver gives its
    robot some seconds to confirm that it stands."""
    leave_s: float = 8.0
    """Time for a cancelled job to stop its robots and write down what it has: longer than the
    ``END_S`` of ``patience.calls``, in which each of its calls has to end."""
    abort_s: float = 20.0
    """Time for the unit to come to rest when the daemon ends: longer than stop and leave
    together."""
    open_record_s: float = 30.0
    """Time for the disk to take the row and the files of a run; nothing has moved yet."""
    close_record_s: float = 15.0
    """Time for the disk to take the end of a run, which the line waits for."""


USUAL = TimeLimits()
