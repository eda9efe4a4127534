"""The unit and its line: takes commands, shows the status."""

import asyncio
import math

from cellctl import log
from cellctl.api.modbus.interface import PlcPort
from cellctl.clock import now_s
from cellctl.command.authority import judge_authority
from cellctl.command.tracker import LineCoupling
from cellctl.errors.records import DiskSilent, RecordsError
from cellctl.packml.command import COMMANDS, Command
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.packml.unit_command import UnitCommand
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore
from cellctl.runtime.unit import MAY_MOVE, UnitController

_log = log.get(__name__)

DISK_TIMEOUT_S = 3.0
"""A command that may move is refused when its number is not on the disk after this time."""


class Line:
    """Judges and obeys the commands of the line, and those of the terminal.

    A command that was given before a Stop or an Abort, or before a command of the other side was
    obeyed, is not obeyed after it: who gave it did not know.
    """

    def __init__(self, unit: UnitController, archive: AsyncRunStore) -> None:
        self._unit = unit
        self._archive = archive
        self._port: PlcPort | None = None
        self._coupling: LineCoupling | None = None
        self._turn = asyncio.Lock()
        self._stopped_s = -math.inf
        """When the last Stop or Abort arrived."""
        self._obeyed_s = {False: -math.inf, True: -math.inf}
        """When a command of the line, and one of the terminal, was obeyed last."""

    @property
    def alive(self) -> bool:
        """True while the PLC's heartbeat changes in time."""
        return self._port is not None and self._port.line_alive

    def attach(self, port: PlcPort) -> None:
        """Give the unit its port; once, before the port starts."""
        unit = self._unit
        unit.machine.on_change.append(lambda _before, _after: self.publish())
        unit.machine.on_fault.append(lambda _error: self.publish())
        self._port = port
        self._coupling = LineCoupling(unit.machine, port.finish, lambda: unit.jobs.result)

    async def take(self, command: UnitCommand) -> RejectCode:
        """Judge a command and obey it; Stop and Abort are obeyed whatever else they ask for."""
        code = RejectCode.NONE if command.ends_motion else await self.judge(command)
        return code or await self.obey(command)

    async def judge(self, command: UnitCommand) -> RejectCode:
        """Why a command other than Stop and Abort is refused.

        What waits for the disk is given up after ``DISK_TIMEOUT_S``, with a fault.
        """
        try:
            async with asyncio.timeout(DISK_TIMEOUT_S):
                code = self._judge_standing(command) or await self._note(command)
                code = code or await self._acknowledge(command)
                return code or await self._judge_start(command)
        except TimeoutError:
            late = DiskSilent(f"{DISK_TIMEOUT_S:g} s for command {command.seq} of {command.who}")
            await self._unit.machine.fail(late)
            return RejectCode.RECORDS_NOT_READY

    async def obey(self, command: UnitCommand) -> RejectCode:
        """Begin a command that was judged; waits for nothing but the machine's turn."""
        if command.ends_motion:
            self._stopped_s = max(self._stopped_s, command.arrived_s)
            self._obeyed_s[command.local] = now_s()
            self._note_soon(command)
            return await self._begin(command)
        async with self._turn:
            code = self._judge_standing(command)
            if code is not RejectCode.NONE:
                return code
            mode = self._mode_to_start_in(command)
            if mode is not None:
                self._unit.factory.accept(command, mode)
            code = await self._begin(command)
            if code is RejectCode.NONE and (command.cntrl_cmd or command.unit_mode):
                self._obeyed_s[command.local] = now_s()
            return code

    def publish(self) -> None:
        """Show the line what is going on."""
        unit = self._unit
        if self._port is not None:
            self._port.publish(unit.view.snapshot(unit.jobs.shown, unit.jobs.result, unit.parts))

    def _judge_standing(self, command: UnitCommand) -> RejectCode:
        """Whether it is still its giver's turn; asked again right before it is obeyed."""
        if command.arrived_s < max(self._stopped_s, self._obeyed_s[not command.local]):
            return RejectCode.SUPERSEDED
        return judge_authority(command, self._unit.machine.mode, line_alive=self.alive)

    async def _begin(self, command: UnitCommand) -> RejectCode:
        assert self._coupling is not None
        code = await self._coupling.obey(command)
        if code is RejectCode.NONE:
            self._audit(command)
        return code

    async def _note(self, command: UnitCommand) -> RejectCode:
        """After a restart the number must be known as old, so what may move waits for the disk.

        Everything else does no harm a second time.
        """
        if command.local or command.cntrl_cmd not in MAY_MOVE:
            self._note_soon(command)
            return RejectCode.NONE
        try:
            await self._archive.do(RunStore.note_line_seq, command.seq)
        except RecordsError as error:
            _log.error("command not noted", number=error.number, fault=str(error))
            return RejectCode.RECORDS_NOT_READY
        return RejectCode.NONE

    def _note_soon(self, command: UnitCommand) -> None:
        if not command.local:
            self._unit.background.start(self._archive.do(RunStore.note_line_seq, command.seq))

    async def _acknowledge(self, command: UnitCommand) -> RejectCode:
        if not command.alarm_ack_id:
            return RejectCode.NONE
        try:
            known = await self._unit.alarms.acknowledge(command.alarm_ack_id, command.who)
        except RecordsError as error:
            _log.error("alarm not acknowledged", number=error.number, fault=str(error))
            return RejectCode.RECORDS_NOT_READY
        return RejectCode.NONE if known else RejectCode.ALARM_UNKNOWN

    async def _judge_start(self, command: UnitCommand) -> RejectCode:
        mode = self._mode_to_start_in(command)
        return RejectCode.NONE if mode is None else await self._unit.factory.validate(command, mode)

    def _mode_to_start_in(self, command: UnitCommand) -> Mode | None:
        """None unless it is a Start that the tables take; they refuse other states and modes."""
        machine = self._unit.machine
        if command.cntrl_cmd != Command.START or machine.state is not State.IDLE:
            return None
        try:
            return Mode(command.unit_mode or machine.mode)
        except ValueError:
            return None

    def _audit(self, command: UnitCommand) -> None:
        names = {int(known): known.name.lower() for known in COMMANDS}
        detail: dict[str, int | str] = {"mode": self._unit.machine.mode.name.lower()}
        if not command.local:
            detail["seq"] = command.seq
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
                command.who,
                names.get(command.cntrl_cmd, "set"),
                detail,
            )
        )
