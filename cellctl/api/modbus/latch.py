"""The handshake with the line PLC: when its registers are a command, and what becomes of it.

Registers 0 to 26 and 28 to 39 are read as a command at the moment when ``cmd_seq`` is another than
the one that the same client wrote before. Each client has numbers and words of its own: a PLC that
writes its whole image again and again says nothing new with it, also when another client has given
a command in between.

The first number of a client after a start of the cell is suspect, because it may have been in the
PLC for days. Accepted are 1, with which a PLC says that it begins anew, and the number after
``ack_seq``, which only who has read it can know; neither when it was the last number before the
start. Commands that can only halt the unit are accepted with any first number, and with the number
of another command before them: an old Stop does no harm, and a new one that is ignored leaves a
robot moving.
"""

from collections.abc import Sequence

from cellctl.api.modbus.encoding import WordOrder, decode
from cellctl.api.modbus.register_map import item
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.unit_command import Options, Source, UnitCommand


class CommandLatch:
    """Reads the holding registers after each commit and keeps the numbers of the handshake.

    The PLC sees two numbers: ``ack_seq``, the last command that was accepted or refused, and
    ``done_seq``, the last one that has ended. They differ while a command is being executed.
    """

    def __init__(self, previous_seq: int | None, order: WordOrder) -> None:
        """``previous_seq``: number of the last command before this start, None if not known."""
        self._previous_seq = previous_seq
        self._order = order
        self._seen: dict[str, tuple[int, int]] = {}
        """Last ``cmd_seq`` of each client, and the command that came with it."""
        self._heard: set[str] = set()
        """Clients that have given a number other than 0 since the start."""
        self._last_client: str | None = None
        self._begun: tuple[int, Result] | None = None
        self.ack_seq = 0
        self.done_seq = 0
        self.result = Result.NONE
        self.reject_code = RejectCode.NONE

    def commit(self, holding: Sequence[int], client: str) -> tuple[int, UnitCommand] | None:
        """The number and the command in the holding registers, which this client has written.

        None when they are no new command: the same number again, 0, or left from before the start.
        """
        seq, command = _number(holding, "cmd_seq"), _parse(holding, self._order)
        seen_seq, seen_command = self._seen.get(client, (0, 0))
        self._seen[client] = seq, command.cntrl_cmd
        if seq == 0:
            self._begin_anew(client)
            return None
        halts_now = command.only_halts and command.cntrl_cmd != seen_command
        if seq == seen_seq and not halts_now:
            return None
        first, self._last_client = client not in self._heard, client
        self._heard.add(client)
        if first and not (command.only_halts or self._is_counted_on(seq)):
            self._end(seq, Result.IGNORED, RejectCode.IGNORED_AFTER_RESTART)
            return None
        return seq, command

    def _is_counted_on(self, seq: int) -> bool:
        """Whether a first number was made for this handshake, and did not stand there before."""
        after_the_last = self.ack_seq != 0 and seq == self.ack_seq + 1
        return (seq == 1 or after_the_last) and seq != self._previous_seq

    def _begin_anew(self, client: str) -> None:
        """A PLC that clears its registers begins the handshake anew.

        It does not lift the rule for the first number: the next one may still be an old one. And it
        takes no answer away for which another client waits.
        """
        if self._last_client in {None, client}:
            self.ack_seq = self.done_seq = 0
            self.result, self.reject_code = Result.NONE, RejectCode.NONE

    def begin(self, seq: int) -> None:
        """The command is being submitted. It may end before it is known to be accepted."""
        self._begun = (seq, Result.NONE)

    def accept(self, seq: int) -> None:
        """The command is being executed."""
        self.ack_seq, self.result, self.reject_code = seq, Result.NONE, RejectCode.NONE
        early, self._begun = self._begun, None
        if early is not None and early[1] is not Result.NONE:
            self.finish(seq, early[1])

    def reject(self, seq: int, code: RejectCode) -> None:
        """The command will not be executed."""
        self._begun = None
        self._end(seq, Result.REJECTED, code)

    def supersede(self, seq: int) -> None:
        """A command that waited in the queue was dropped; another one may be in submission."""
        self._end(seq, Result.REJECTED, RejectCode.SUPERSEDED)

    def finish(self, seq: int, result: Result) -> bool:
        """The command has ended; False when a later one has taken its place."""
        if self._begun is not None and seq == self._begun[0]:
            # Shown by ``accept`` only: the PLC must see ack_seq before, or together with, done_seq.
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
    return UnitCommand(
        Source.LINE,
        unit_mode=_number(holding, "unit_mode"),
        cntrl_cmd=_number(holding, "cntrl_cmd"),
        recipe_id=_number(holding, "recipe_id"),
        options=Options(_number(holding, "options")),
        serial=str(decode(item("serial"), holding, order)),
        mate_serial=str(decode(item("mate_serial"), holding, order)),
        order=str(decode(item("order"), holding, order)),
        alarm_ack_id=_number(holding, "alarm_ack_id"),
    )


def _number(holding: Sequence[int], name: str) -> int:
    return holding[item(name).address]
