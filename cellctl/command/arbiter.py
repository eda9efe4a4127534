"""Decides which command is executed, and when: the one entrance for all interfaces."""

import asyncio
from collections.abc import Callable, Mapping

from cellctl import log
from cellctl.command.latest import TakenCommand
from cellctl.command.refusal_notes import RefusalNotes
from cellctl.command.submission import Submission
from cellctl.command.tracker import CommandTracker
from cellctl.command.validator import CommandValidator, start_mode
from cellctl.errors.records.store import DiskSilent, RecordsError
from cellctl.packml.command import COMMAND_NAMES, Command
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.unit_command import UnitCommand
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entered.said_by import ORDER, REFUSED
from cellctl.records.store import RunStore
from cellctl.runtime.unit import MAY_MOVE, UnitController

_log = log.get(__name__)

DISK_TIMEOUT_S = 3.0
"""A command is refused when what it needs from the disk is not there after this time. A disk that
works takes milliseconds, and a PLC or an operator wants an answer."""


class CommandArbiter:
    """Validates and executes commands of all sources, one at a time. Belongs to one event loop.

    Stop and Abort wait for no validation, no disk and no other command.
    """

    def __init__(
        self,
        unit: UnitController,
        store: AsyncRunStore,
        *,
        line_alive: Callable[[], bool],
        disk_timeout_s: float = DISK_TIMEOUT_S,
    ) -> None:
        """``line_alive``: whether the heartbeat of the line PLC is present."""
        self._unit = unit
        self._store = store
        self._line_alive = line_alive
        self._disk_timeout_s = disk_timeout_s
        self._validator = CommandValidator(unit.machine, unit.factory, line_alive)
        self._tracker = CommandTracker(unit.machine, lambda: unit.jobs.result)
        # Not taken while a command is validated: validation waits for the disk, and no other
        # command should wait for that.
        self._turn = asyncio.Lock()
        self._refusals = RefusalNotes()
        self.latest: TakenCommand | None = None
        """The newest command of any source since the daemon started."""

    @property
    def line_alive(self) -> bool:
        """True while the heartbeat of the line PLC is present."""
        return self._line_alive()

    async def submit(self, submission: Submission) -> RejectCode:
        """Validate and execute a command; NONE when it is being executed.

        The answer comes when the audit log has the command on disk, that of Stop and Abort and a
        refusal at once.

        The submission hears of the command's end, which may come before this returns. Raises the
        numbered fault of a device that broke.
        """
        code = await self._submitted(submission)
        if code is not RejectCode.NONE:
            self.note_refusal(submission.command, code, submission.reference)
        return code

    async def _submitted(self, submission: Submission) -> RejectCode:
        command = submission.command
        if command.ends_motion:
            return await self._end_motion(submission)
        code = await submission.unless_overtaken(self._validate(submission))
        if code is not RejectCode.NONE:
            self._unit.machine.refused(command.cntrl_cmd, code, command.unit_mode)
            return code
        code = await self._execute(submission)
        if code is RejectCode.NONE:
            await submission.or_overtaken(self._written(submission))
        return code

    def note_refusal(
        self, command: UnitCommand, code: RejectCode, details: Mapping[str, int | str]
    ) -> None:
        """Have the audit log say, some time soon, what somebody was refused and why.

        Of refusals that come by the hundred it says how many it leaves out.
        """
        left_out = self._refusals.take(command.source)
        if left_out is None:
            return
        detail: dict[str, int | str] = {
            **details,
            **_asked(command),
            REFUSED: code.text,
            "reject_code": int(code),
            "state": self._unit.machine.state.name.lower(),
        }
        if command.unit_mode:
            detail["mode"] = _mode_name(command.unit_mode)
        if left_out:
            detail["refusals_left_out_before"] = left_out
        writing = self._store.do(RunStore.audit, command.who, _name(command), detail)
        self._unit.background.start(writing)

    def _taken(self, submission: Submission) -> None:
        self.latest = TakenCommand.of(submission.command)
        submission.taken()

    async def _validate(self, submission: Submission) -> RejectCode:
        """Carry out what may wait for the disk; a disk that does not answer is a fault."""
        command = submission.command
        try:
            async with asyncio.timeout(self._disk_timeout_s):
                code = self._validator.validate(submission) or await self._remember(submission)
                code = code or await self._acknowledge(command)
                return code or await self._validator.validate_start(command)
        except TimeoutError:
            what = f"{_name(command)} of {command.who}"
            await self._unit.machine.fail(DiskSilent(f"{self._disk_timeout_s:g} s for {what}"))
            return RejectCode.RECORDS_NOT_READY

    async def _execute(self, submission: Submission) -> RejectCode:
        """Execute a validated command; waits for nothing but its turn."""
        command = submission.command
        async with self._turn:
            # Another command may have been executed while this one waited for disk and turn.
            code = self._validator.validate_turn(command)
            if code is not RejectCode.NONE:
                self._unit.machine.refused(command.cntrl_cmd, code, command.unit_mode)
                return code
            # Accepted inside the turn: of two Starts that were validated at the same time, the one
            # that is refused below must not leave its parameters behind for the other one's job.
            mode = start_mode(command, self._unit.machine)
            if mode is not None:
                self._unit.factory.accept(command, mode)
            code = await self._tracker.execute(submission)
            if code is RejectCode.NONE:
                self._taken(submission)
            if code is RejectCode.NONE and (command.cntrl_cmd or command.unit_mode):
                # An acknowledged alarm alone changes nothing that another client decided upon.
                self._validator.executed(command)
            return code

    async def _end_motion(self, submission: Submission) -> RejectCode:
        """Stop or Abort, at once: neither the lock of the turn nor the disk may delay it."""
        self._validator.executed(submission.command)
        self._unit.background.start(submission.remember())
        code = await self._tracker.execute(submission)
        if code is RejectCode.NONE:
            self._taken(submission)
            # In the background: nothing that can fail or wait stands beside ending motion.
            self._unit.background.start(self._audit(submission))
        return code

    async def _written(self, submission: Submission) -> None:
        """Wait until the audit log has a command that is being executed, for as long as is due.

        A disk that does not answer is a fault of its own; the command cannot be taken back.
        """
        try:
            async with asyncio.timeout(self._disk_timeout_s):
                await self._audit(submission)
        except TimeoutError:
            what = f"{self._disk_timeout_s:g} s for the audit line of {_name(submission.command)}"
            await self._unit.machine.fail(DiskSilent(what))
        except RecordsError as error:
            _log.error("audit line not written", number=error.number, fault=str(error))

    async def _remember(self, submission: Submission) -> RejectCode:
        """Have the client remember the command, on disk before anything may move.

        All other commands do no harm when a restart lets them be executed a second time, so they
        do not wait.
        """
        if submission.command.cntrl_cmd not in MAY_MOVE:
            self._unit.background.start(submission.remember())
            return RejectCode.NONE
        try:
            await submission.remember()
        except RecordsError as error:
            _log.error("command not remembered", number=error.number, fault=str(error))
            return RejectCode.RECORDS_NOT_READY
        return RejectCode.NONE

    async def _acknowledge(self, command: UnitCommand) -> RejectCode:
        if not command.alarm_ack_id:
            return RejectCode.NONE
        try:
            known = await self._unit.alarms.acknowledge(
                command.alarm_ack_id, command.who, command.alarms_seen
            )
        except RecordsError as error:
            _log.error("alarm not acknowledged", number=error.number, fault=str(error))
            return RejectCode.RECORDS_NOT_READY
        return RejectCode.NONE if known else RejectCode.ALARM_UNKNOWN

    async def _audit(self, submission: Submission) -> None:
        command = submission.command
        detail: dict[str, int | str] = {"mode": self._unit.machine.mode.name.lower()}
        detail |= {**submission.reference, **_asked(command)}
        await self._store.do(RunStore.audit, command.who, _name(command), detail)


def _asked(command: UnitCommand) -> dict[str, int | str]:
    """What a command asks for besides its name and mode, for the audit log."""
    asked: dict[str, int | str] = {}
    if command.order:
        asked[ORDER] = command.order
    if command.cntrl_cmd == Command.START:
        asked |= {
            "recipe": command.recipe_id,
            "serial": command.serial,
            "mate_serial": command.mate_serial,
            "options": int(command.options),
        }
    if command.alarm_ack_id:
        asked["acknowledged"] = command.alarm_ack_id
    return asked


def _mode_name(number: int) -> str:
    """The number itself where the line has asked for a mode that there is not."""
    return Mode(number).name.lower() if number in set(Mode) else str(number)


def _name(command: UnitCommand) -> str:
    """Name of the command for records; "set" for one that sets a mode or acknowledges an alarm."""
    return COMMAND_NAMES.get(command.cntrl_cmd, "set")
