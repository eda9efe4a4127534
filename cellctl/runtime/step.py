"""The inner states of Execute, with the numbers that the PLC and the record see."""

from enum import IntEnum


class Step(IntEnum):
    """Production runs the steps 10 … 60 in this order; compensation iterates (mission A)."""

    NONE = 0
    MEASURE_FRAME = 10
    MEASURE_DECK = 20
    PRE_ASSEMBLY = 30
    COMPENSATE = 40
    MATE = 50
    VERIFY = 60
    CALIBRATE_HEAD_1 = 101
    CALIBRATE_HEAD_2 = 102
    CALIBRATE_BASE_FRAME = 103
    CALIBRATE_BOARD_1 = 104
    CALIBRATE_BOARD_2 = 105
    IDENTIFY_PAYLOAD = 106
    MEASURE_STOP_LATENCY = 107
    MEASURE_CONTACT_STIFFNESS = 108

    @property
    def label(self) -> str:
        """Words for logs, reports and terminals."""
        return self.name.replace("_", " ").lower()
