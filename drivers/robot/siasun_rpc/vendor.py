"""Numbers of the controller and what they mean (vendor's manual of the remote interface)."""

from enum import IntEnum


class TaskState(IntEnum):
    """How far a motion is. Without blending only FINISHED is a good end (API V2.9)."""

    IDLE = 0
    RUNNING = 1
    PAUSED = 2
    STOPPED = 3
    FINISHED = 4
    INTERRUPTED = 5
    ERROR = 6
    ILLEGAL = 7
    PARAMETERS = 8


class Power(IntEnum):
    """State of the robot; only ENABLED moves."""

    START = 0
    INIT = 1
    LOGOUT = 2
    LOGIN = 3
    POWER_OFF = 4
    DISABLED = 5
    ENABLED = 6
    UPDATE = 7


class OperationMode(IntEnum):
    """Key or choice at the pendant."""

    MANUAL = 0
    AUTOMATIC = 1
    REMOTE = 2


class SafetyState(IntEnum):
    """State of the controller's safety functions."""

    INIT = 0
    WAIT = 2
    CONFIGURATION = 3
    POWER_OFF = 4
    RUN = 5
    RECOVERY = 6
    STOP_2 = 7
    STOP_1 = 8
    STOP_0 = 9
    MODEL = 10
    REDUCED = 12
    BOOT = 13
    FAIL = 14
    UPDATE = 99


def name(kind: type[IntEnum], number: int) -> str:
    """The name of a number, or the number itself when this driver does not know it."""
    known = {member.value: member.name.lower().replace("_", " ") for member in kind}
    return f"{known.get(number, 'unknown')} ({number})"
