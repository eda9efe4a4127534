"""35x: digital inputs and outputs."""

from cellctl.errors.base import CellError, Reaction


class DigitalIoError(CellError):
    """Inputs and outputs cannot be used as asked."""


class SignalUnknown(DigitalIoError):
    """A signal was asked for that the cell file does not name."""

    number = 351
    text = "Digital signal is not in the cell file"
    cause = "The recipe or process names a signal that this cell does not have."
    remedy = "Compare the names in the detail with the device's inputs and outputs."
    reaction = Reaction.STOP


class OutputsDropped(DigitalIoError):
    """Outputs are no longer what this PC has set them to."""

    number = 352
    text = "Digital outputs changed by themselves"
    cause = (
        "The I/O coupler's watchdog ran down, as when this PC is too busy to write in time; its "
        "supply failed, or something else writes to it."
    )
    remedy = (
        "Find out why before clearing; look what the actuators have done meanwhile. A PC that was "
        "too busy says so in its log (`event loop held`)."
    )


class WatchdogUnsuitable(DigitalIoError):
    """The I/O coupler would keep its outputs on when this PC is gone."""

    number = 353
    text = "Watchdog of an I/O coupler is off or too slow"
    cause = "The coupler was never commissioned for this cell, or it lost its settings."
    remedy = "Set the watchdog as the driver's README says, then connect again."
    reaction = Reaction.STOP
