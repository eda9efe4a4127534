"""States of a unit, with the numbers of ISA-TR88.00.02 (2022 edition)."""

from enum import IntEnum


class State(IntEnum):
    """The numbers must never change. OPC 30060 uses the same names with other numbers."""

    UNDEFINED = 0
    CLEARING = 1
    STOPPED = 2
    STARTING = 3
    IDLE = 4
    SUSPENDED = 5
    EXECUTE = 6
    STOPPING = 7
    ABORTING = 8
    ABORTED = 9
    HOLDING = 10
    HELD = 11
    UNHOLDING = 12
    SUSPENDING = 13
    UNSUSPENDING = 14
    RESETTING = 15
    COMPLETING = 16
    COMPLETED = 17


STATES = tuple(state for state in State if state is not State.UNDEFINED)
"""The 17 states of the machine."""
