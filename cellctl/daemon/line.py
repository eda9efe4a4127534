"""The unit and its line: takes commands, shows the status."""

import asyncio

from cellctl import log
from cellctl.cell.archive import Archive
from cellctl.daemon.unit import MAY_MOVE, Unit
from cellctl.errors.records import DiskSilent, RecordsError
from cellctl.packml.command import COMMANDS, Command
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.plc.commands import LineCommand
from cellctl.plc.coupling import LineCoupling
from cellctl.plc.port import PlcPort
from cellctl.records.store import RunStore

_log = log.get(__name__)

DISK_TIMEOUT_S = 3.0
"""A command that may move is refused when its number is not on the disk after this time."""


class Line:
    """Judges and obeys the commands that the port hands over."""

    def __init__(self, unit: Unit, archive: Archive) -> None:
        self._unit = unit
        self._archive = archive
        self._port: PlcPort | None = None
        self._coupling: LineCoupling | None = None

    def attach(self, port: PlcPort) -> None:
        """Give the unit its port; once, before the port starts."""
        unit = self._unit
        unit.machine.on_change.append(lambda _before, _after: self.publish())
        unit.machine.on_fault.append(lambda _error: self.publish())
        self._port = port
        self._coupling = LineCoupling(unit.machine, port.finish, lambda: unit.work.result)

    async def take(self, command: LineCommand) -> RejectCode:
        """Judge a command and obey it; Stop and Abort are obeyed whatever else they ask for."""
        code = RejectCode.NONE if command.ends_motion else await self.judge(command)
        return code or await self.obey(command)

    async def judge(self, command: LineCommand) -> RejectCode:
        """Why a command other than Stop and Abort is refused.

        What waits for the disk is given up after ``DISK_TIMEOUT_S``, with a fault.
        """
        try:
            async with asyncio.timeout(DISK_TIMEOUT_S):
                code = await self._note(command) or await self._acknowledge(command)
                return code or await self._judge_start(command)
        except TimeoutError:
            late = DiskSilent(f"{DISK_TIMEOUT_S:g} s for command {command.seq} of the line")
            await self._unit.machine.fail(late)
            return RejectCode.RECORDS_NOT_READY

    async def obey(self, command: LineCommand) -> RejectCode:
        """Begin a command that was judged; waits for nothing but the machine's turn."""
        assert self._coupling is not None
        if command.ends_motion:
            self._note_soon(command)
        code = await self._coupling.obey(command)
        if code is RejectCode.NONE:
            self._audit(command)
        return code

    def publish(self) -> None:
        """Show the line what is going on."""
        unit = self._unit
        if self._port is not None:
            self._port.publish(unit.view.snapshot(unit.work.shown, unit.work.result, unit.parts))

    async def _note(self, command: LineCommand) -> RejectCode:
        """After a restart the number must be known as old, so what may move waits for the disk.

        Everything else does no harm a second time.
        """
        if command.cntrl_cmd not in MAY_MOVE:
            self._note_soon(command)
            return RejectCode.NONE
        try:
            await self._archive.do(RunStore.note_line_seq, command.seq)
        except RecordsError as error:
            _log.error("command not noted", number=error.number, fault=str(error))
            return RejectCode.RECORDS_NOT_READY
        return RejectCode.NONE

    def _note_soon(self, command: LineCommand) -> None:
        self._unit.background.start(self._archive.do(RunStore.note_line_seq, command.seq))

    async def _acknowledge(self, command: LineCommand) -> RejectCode:
        if not command.alarm_ack_id:
            return RejectCode.NONE
        try:
            known = await self._unit.alarms.acknowledge(
                command.alarm_ack_id, command.order or "line"
            )
        except RecordsError as error:
            _log.error("alarm not acknowledged", number=error.number, fault=str(error))
            return RejectCode.RECORDS_NOT_READY
        return RejectCode.NONE if known else RejectCode.ALARM_UNKNOWN

    async def _judge_start(self, command: LineCommand) -> RejectCode:
        """What the tables cannot know; they refuse Start in other states and unknown modes."""
        machine = self._unit.machine
        if command.cntrl_cmd != Command.START or machine.state is not State.IDLE:
            return RejectCode.NONE
        try:
            mode = Mode(command.unit_mode or machine.mode)
        except ValueError:
            return RejectCode.NONE
        return await self._unit.desk.judge(command, mode)

    def _audit(self, command: LineCommand) -> None:
        names = {int(known): known.name.lower() for known in COMMANDS}
        detail = {"seq": command.seq, "mode": self._unit.machine.mode.name.lower()}
        if command.cntrl_cmd == Command.START:
            detail |= {
                "recipe": command.recipe_id,
                "serial": command.serial,
                "options": command.options,
            }
        if command.alarm_ack_id:
            detail["acknowledged"] = command.alarm_ack_id
        self._unit.background.start(
            self._archive.do(
                RunStore.audit,
                command.order or "line",
                names.get(command.cntrl_cmd, "set"),
                detail,
            )
        )
