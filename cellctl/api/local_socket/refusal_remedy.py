"""What somebody at the terminal does about a refusal."""

from collections.abc import Mapping

from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.unit_command import UnitCommand

_STATUS = "`cellctl status` shows the reason"
_REMEDIES: Mapping[RejectCode, str] = {
    RejectCode.MODE_CHANGE_NOT_ALLOWED: "end the run first, by `cellctl stop` if it must be now",
    RejectCode.STATE_NOT_IN_MODE: "leave Manual first: `cellctl mode production` or `maintenance`",
    RejectCode.SERIAL_INVALID: "give a serial number of capital letters, digits and . _ -",
    RejectCode.ORDER_INVALID: "give an order of capital letters, digits and . _ -",
    RejectCode.CALIBRATION_INVALID: f"{_STATUS} beside the calibration; its procedure renews it",
    RejectCode.DEVICE_NOT_READY: f"{_STATUS} under links",
    RejectCode.RECORDS_NOT_READY: f"{_STATUS} under records",
    RejectCode.ALARM_UNKNOWN: "`cellctl alarms` lists the active ones",
    RejectCode.SUPERSEDED: "look at `cellctl status`, then ask again",
    RejectCode.LINE_IN_CONTROL: "leave it to the line, or let it change the mode to Maintenance",
}


def remedy(code: RejectCode, command: UnitCommand) -> str:
    """What to do, in words; empty where what is permitted, or what the cell has, says it."""
    if code is RejectCode.OTHER_MODE:
        return f"`cellctl mode {Mode(command.in_mode).name.lower()}` first"
    return _REMEDIES.get(code, "")
