"""7xx: the line PLC and commands."""

from cellctl.errors.base import CellError, Reaction


class LineError(CellError):
    """The line asked for something that cannot be done, or vanished."""


class LineLost(LineError):
    """The PLC's heartbeat stands still."""

    number = 701
    text = "Line PLC lost"
    cause = "PLC stopped, network broken, or its program no longer writes plc_heartbeat."
    remedy = "Restore the PLC; then Unhold, or Stop and Reset."
    reaction = Reaction.HOLD


class LineLostInContact(LineLost):
    """The PLC's heartbeat stands still while a part is being touched."""

    number = 704
    text = "Line PLC lost while in contact"
    cause = "As 701. The recipe's line_lost_in_contact says whether the arm stays or backs off."
    remedy = "Restore the PLC. Look at the part, then Clear and Reset."
    reaction = Reaction.ABORT


class SerialMadeBefore(LineError):
    """A part with the serial number of this run was finished before; the run goes on."""

    number = 742
    text = "A part with this serial number was finished before"
    cause = "The number was mistyped, read from another part or left from the part before; or the "
    cause += "part is reworked, or several others are joined to it."
    remedy = "Compare the number with the part. If it is wrong, stop the run and start it with the "
    remedy += "right one; if it is right, acknowledge the alarm."
    reaction = Reaction.WARN


class CannotListen(LineError):
    """The Modbus server cannot be opened."""

    number = 702
    text = "Cannot open the port for the line PLC"
    cause = "Address not on this PC, or a port below 1024 without the permission for it."
    remedy = "Check plc.host and plc.port in the cell file."
    reaction = Reaction.STOP


class LineTaskDied(LineError):
    """The task that takes the line's commands ended."""

    number = 703
    text = "The line interface has stopped taking commands"
    cause = "A defect in cellctl."
    remedy = "Restart the daemon; keep the log."
