"""Commands of the line: when they count, what they say, what has become of them.

Everything in registers 0-26 counts at the moment ``cmd_seq`` changes. The first number after a
start of the cell is suspect: it may have stood in the PLC for days. Only 1, which says that the PLC
begins anew, is taken, and not even 1 when that was the last number before the start.
"""

from collections.abc import Sequence

from cellctl.api.modbus.image import WordOrder, decode
from cellctl.api.modbus.register_map import item
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.unit_command import UnitCommand


class CommandLatch:
    """Sees the holding registers after each commit and keeps the handshake's numbers."""

    def __init__(self, previous_seq: int | None, order: WordOrder) -> None:
        """``previous_seq`` is the last number taken before this start, if it is known."""
        self._previous_seq = previous_seq
        self._order = order
        self._fresh = True
        self._seen = 0
        self._begun: tuple[int, Result] | None = None
        self.ack_seq = 0
        self.done_seq = 0
        self.result = Result.NONE
        self.reject_code = RejectCode.NONE

    def commit(self, holding: Sequence[int]) -> UnitCommand | None:
        """A command that counts, or None: the same number again, 0, or left from before."""
        command = _parse(holding, self._order)
        if command.seq == self._seen:
            return None
        self._seen = command.seq
        if command.seq == 0:
            self.ack_seq = self.done_seq = 0
            self.result, self.reject_code = Result.NONE, RejectCode.NONE
            return None
        fresh, self._fresh = self._fresh, False
        if fresh and (command.seq != 1 or self._previous_seq == 1):
            self._end(command.seq, Result.IGNORED, RejectCode.IGNORED_AFTER_RESTART)
            return None
        return command

    def begin(self, seq: int) -> None:
        """Somebody is deciding about the command; it may already end before it is accepted."""
        self._begun = (seq, Result.NONE)

    def accept(self, seq: int) -> None:
        """The command is taken."""
        self.ack_seq, self.result, self.reject_code = seq, Result.NONE, RejectCode.NONE
        early, self._begun = self._begun, None
        if early is not None and early[1] is not Result.NONE:
            self.finish(seq, early[1])

    def reject(self, seq: int, code: RejectCode) -> None:
        """The command will not be carried out."""
        self._begun = None
        self._end(seq, Result.REJECTED, code)

    def supersede(self, seq: int) -> None:
        """A waiting command was dropped, whatever is being decided meanwhile."""
        self._end(seq, Result.REJECTED, RejectCode.SUPERSEDED)

    def finish(self, seq: int, result: Result) -> bool:
        """The command has ended; False when a later one has taken its place."""
        if self._begun is not None and seq == self._begun[0]:
            self._begun = (seq, result)
            return True
        if seq != self.ack_seq or self.ack_seq == self.done_seq:
            return False
        self.done_seq, self.result = seq, result
        return True

    def _end(self, seq: int, result: Result, code: RejectCode) -> None:
        self.ack_seq = self.done_seq = seq
        self.result, self.reject_code = result, code


def _parse(holding: Sequence[int], order: WordOrder) -> UnitCommand:
    def number(name: str) -> int:
        return holding[item(name).address]

    return UnitCommand(
        seq=number("cmd_seq"),
        unit_mode=number("unit_mode"),
        cntrl_cmd=number("cntrl_cmd"),
        recipe_id=number("recipe_id"),
        options=number("options"),
        serial=str(decode(item("serial"), holding, order)),
        order=str(decode(item("order"), holding, order)),
        alarm_ack_id=number("alarm_ack_id"),
    )
