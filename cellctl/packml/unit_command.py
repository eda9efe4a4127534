"""A command to the unit, in the one form in which the line and an operator's terminal give it."""

import re
from dataclasses import dataclass, field

from cellctl.clock import now_s
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode

_CHARSET = re.compile(r"[A-Z0-9._-]*")
DRY_RUN, SINGLE_STEP = 0b01, 0b10
"""Bits of the options."""


@dataclass(frozen=True, slots=True)
class UnitCommand:
    """What the PLC asked for, as it stood when it was committed. Numbers are not yet judged.

    An operator at the cell's terminal asks in the same form, without a number.
    """

    seq: int
    unit_mode: int
    cntrl_cmd: int
    recipe_id: int
    options: int
    serial: str
    order: str
    alarm_ack_id: int
    by: str = ""
    """Who asks at the terminal; empty for the line."""
    arrived_s: float = field(default_factory=now_s, compare=False)
    """Monotonic."""

    @property
    def local(self) -> bool:
        """True for a command of the terminal."""
        return bool(self.by)

    @property
    def who(self) -> str:
        """Who asks, for the audit log."""
        return self.by or self.order or "line"

    @property
    def dry_run(self) -> bool:
        """Option bit 0."""
        return bool(self.options & DRY_RUN)

    @property
    def single_step(self) -> bool:
        """Option bit 1."""
        return bool(self.options & SINGLE_STEP)

    @property
    def ends_motion(self) -> bool:
        """Stop and Abort are taken whatever else is wrong."""
        return self.cntrl_cmd in (Command.STOP, Command.ABORT)

    def judge(self) -> RejectCode:
        """What is wrong with the parameters in themselves."""
        if self.ends_motion:
            return RejectCode.NONE
        starts = self.cntrl_cmd == Command.START
        if not _CHARSET.fullmatch(self.serial) or (starts and not self.serial):
            return RejectCode.SERIAL_INVALID
        if not _CHARSET.fullmatch(self.order):
            return RejectCode.ORDER_INVALID
        if self.options & ~(DRY_RUN | SINGLE_STEP):
            return RejectCode.OPTIONS_UNKNOWN
        return RejectCode.NONE
