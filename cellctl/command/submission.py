"""A command on its way through the arbiter, together with the client that gave it."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.unit_command import UnitCommand

T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Submission:
    """What the arbiter needs of a client besides the command.

    A client that only waits for the reject code uses this class as it is. An interface with a
    handshake derives its own class and overrides what it needs. All methods are called on the
    event loop of the arbiter.
    """

    command: UnitCommand

    @property
    def reference(self) -> Mapping[str, int | str]:
        """How the client itself identifies the command; goes into the audit log."""
        return {}

    def link_fault(self) -> RejectCode:
        """Why the link to the client allows nothing but Stop and Abort now; NONE when it is whole.

        A client whose link is dead would not see what its command does.
        """
        return RejectCode.NONE

    async def remember(self) -> None:
        """Write to disk that this command was taken, so that a restart does not repeat it.

        Raises ``RecordsError``. Awaited before anything may move; in the background otherwise.
        """

    async def overtaken(self) -> None:
        """Return as soon as the client has given a Stop or an Abort that waits for this command."""
        await asyncio.Event().wait()  # a client without a queue never lets a Stop wait

    def taken(self) -> None:
        """The command is being executed; the answer follows when it is on record."""

    def ended(self, result: Result) -> None:
        """The accepted command has reached its end. Not called for a refused command."""

    async def unless_overtaken(self, validation: Coroutine[Any, Any, RejectCode]) -> RejectCode:
        """The code of the validation, or SUPERSEDED as soon as ``overtaken`` returns.

        Validation waits for the disk, and a Stop must not. Only validation may be cancelled this
        way: nothing has been given to the state machine yet.
        """
        code = await self._or_overtaken(validation, "validation of a command")
        return RejectCode.SUPERSEDED if code is None else code

    async def or_overtaken(self, record: Coroutine[Any, Any, None]) -> None:
        """Wait for the record of a command that is being executed, until ``overtaken`` returns.

        The record is written all the same, because the store carries out whatever was handed to
        it. Only nobody waits for it any more.
        """
        await self._or_overtaken(record, "record of a command")

    async def _or_overtaken(self, work: Coroutine[Any, Any, T], name: str) -> T | None:
        """The result of the work, None as soon as ``overtaken`` returns."""
        working = asyncio.create_task(work, name=name)
        overtaking = asyncio.create_task(self.overtaken(), name="stop behind a command")
        try:
            await asyncio.wait({working, overtaking}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            overtaken = overtaking.done()
            for task in (working, overtaking):
                task.cancel()
            # The cancelled work must have let go of the disk before the Stop is executed.
            await asyncio.gather(working, overtaking, return_exceptions=True)
        return None if overtaken else working.result()


Submit = Callable[[Submission], Awaitable[RejectCode]]
"""``CommandArbiter.submit``, as the interfaces see it."""
NoteRefusal = Callable[[UnitCommand, RejectCode, Mapping[str, int | str]], None]
"""``CommandArbiter.note_refusal``: for what an interface itself refuses."""
