"""A command of the line PLC on its way: it has a sequence number, and the line has a heartbeat."""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass

from cellctl.command.submission import Submission
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result


@dataclass(frozen=True, slots=True, eq=False)
class LineSubmission(Submission):
    """Ties a command to the handshake registers of the PLC."""

    seq: int
    """``cmd_seq`` with which the PLC committed the command."""
    alive: Callable[[], bool]
    """Whether the client that gave the command has a heartbeat."""
    remember_seq: Callable[[int], Awaitable[object]]
    stop_waits: Callable[[], Awaitable[None]]
    on_command: Callable[[], object]
    """Called when this client takes the unit over: from then on its heartbeat is the line's."""
    on_end: Callable[[int, Result], object]

    @property
    def reference(self) -> Mapping[str, int]:
        """The sequence number."""
        return {"seq": self.seq}

    def link_fault(self) -> RejectCode:
        """A line without a heartbeat would not notice what its command does."""
        return RejectCode.NONE if self.alive() else RejectCode.LINE_HEARTBEAT_MISSING

    async def remember(self) -> None:
        """Keep the number: the same one in the registers after a restart is then known as old."""
        await self.remember_seq(self.seq)

    async def overtaken(self) -> None:
        """Return when a Stop or an Abort is in the queue behind this command."""
        await self.stop_waits()

    def taken(self) -> None:
        """Anybody may halt the unit or acknowledge an alarm, and takes nothing over by that."""
        asks_for_more = self.command.cntrl_cmd or self.command.unit_mode
        if asks_for_more and not self.command.only_halts:
            self.on_command()

    def ended(self, result: Result) -> None:
        """Show ``done_seq`` and ``result`` to the PLC."""
        self.on_end(self.seq, result)
