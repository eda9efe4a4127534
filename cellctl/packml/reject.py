"""Why a command was refused: the number in the PLC's `reject_code` and words for the operator."""

from enum import IntEnum


class RejectCode(IntEnum):
    """0x80 to 0x87 as in Siemens' LPMLV2022 library; from 0x100 on this cell's own."""

    NONE = 0
    MODE_UNDEFINED = 0x80
    COMMAND_UNDEFINED = 0x81
    MODE_NOT_CONFIGURED = 0x82
    MODE_CHANGE_NOT_ALLOWED = 0x83
    COMMAND_NOT_ALLOWED = 0x84
    STATE_NOT_IN_MODE = 0x87
    IGNORED_AFTER_RESTART = 0x100
    LINE_HEARTBEAT_MISSING = 0x101
    RECIPE_UNKNOWN = 0x102
    SERIAL_INVALID = 0x103
    ORDER_INVALID = 0x104
    OPTIONS_UNKNOWN = 0x105
    CALIBRATION_INVALID = 0x106
    DEVICE_NOT_READY = 0x107
    RECORDS_NOT_READY = 0x108
    ALARM_UNKNOWN = 0x109
    SUPERSEDED = 0x10A
    LINE_IN_CONTROL = 0x10B
    ROLE_MISSING = 0x10C
    NOT_AT_A_PANEL = 0x10D
    OTHER_MODE = 0x10E

    @property
    def text(self) -> str:
        """Words for the log, the documents and the line's programmer."""
        return _TEXT[self]


_TEXT = {
    RejectCode.NONE: "not refused",
    RejectCode.MODE_UNDEFINED: "no such mode: not 1 to 31",
    RejectCode.COMMAND_UNDEFINED: "no such command",
    RejectCode.MODE_NOT_CONFIGURED: "this cell does not have the mode; others may",
    RejectCode.MODE_CHANGE_NOT_ALLOWED: "mode changes only in Stopped, Idle or Aborted",
    RejectCode.COMMAND_NOT_ALLOWED: "command not allowed in this state",
    RejectCode.STATE_NOT_IN_MODE: "the command leads to a state that this mode does not have",
    RejectCode.IGNORED_AFTER_RESTART: "stood in the registers when the cell started; not executed",
    RejectCode.LINE_HEARTBEAT_MISSING: "no heartbeat from the line PLC; only Stop and Abort",
    RejectCode.RECIPE_UNKNOWN: "no recipe or procedure with this number",
    RejectCode.SERIAL_INVALID: "serial number empty or not of the characters A-Z 0-9 . _ -",
    RejectCode.ORDER_INVALID: "operator or order not of the characters A-Z 0-9 . _ -",
    RejectCode.OPTIONS_UNKNOWN: "an option bit that this version does not know",
    RejectCode.CALIBRATION_INVALID: "a needed calibration is missing, expired or invalidated",
    RejectCode.DEVICE_NOT_READY: "a device is not connected or not ready",
    RejectCode.RECORDS_NOT_READY: "the run store cannot take a run",
    RejectCode.ALARM_UNKNOWN: "no active alarm with this number",
    RejectCode.SUPERSEDED: "a newer command arrived before this one was taken",
    RejectCode.LINE_IN_CONTROL: "to terminal and page only: the line PLC is in control",
    RejectCode.ROLE_MISSING: "to the page only: the person does not have the role for it",
    RejectCode.NOT_AT_A_PANEL: "to the page only: what may move the cell needs a panel at the cell",
    RejectCode.OTHER_MODE: "to terminal and page only: it needs another mode, to be set before",
}
