"""The line's side of the daemon: takes commands, publishes the state, watches heartbeats."""

import asyncio
from collections.abc import Callable
from importlib.metadata import version
from typing import Protocol

from cellctl import log
from cellctl.api.modbus.commands import CommandLatch
from cellctl.api.modbus.heartbeat import HeartbeatWatch
from cellctl.api.modbus.image import input_block
from cellctl.api.modbus.pdu import Responder
from cellctl.api.modbus.registers import RegisterFile
from cellctl.api.modbus.server import ModbusServer, ServerLimits
from cellctl.api.modbus.status import Handshake, values
from cellctl.command.queue import Intake
from cellctl.config.cell import Plc
from cellctl.errors.base import CellError
from cellctl.errors.line import LineTaskDied
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.unit_command import UnitCommand
from cellctl.runtime.cell_status import CellStatus

_log = log.get(__name__)
_IDENTITY = ("cellctl", "cell controller", version("cellctl"))
_QUEUE = 16


class CommandHandler(Protocol):
    """Who decides about the line's commands and has them carried out."""

    async def judge(self, command: UnitCommand) -> RejectCode:
        """Why a command other than Stop and Abort is refused; may wait for the disk.

        Cancelled when a Stop or an Abort overtakes it.
        """

    async def obey(self, command: UnitCommand) -> RejectCode:
        """Begin what was judged well; waits for nothing but the state machine's turn."""


class PlcPort:
    """Modbus TCP server with the register map and its handshake.

    Commands are taken one after the other. Stop and Abort wait for no other command: they take the
    place of all that were not yet obeyed. Whoever carries a command out calls ``finish`` with its
    number at its end. Lives in one event loop.
    """

    def __init__(
        self,
        config: Plc,
        handler: CommandHandler,
        on_plc_lost: Callable[[], None],
        *,
        previous_seq: int | None = None,
        limits: ServerLimits | None = None,
    ) -> None:
        """``previous_seq``: number of the last command before this start, from the run store."""
        self._config = config
        self._handler = handler
        self._on_plc_lost = on_plc_lost
        self._latch = CommandLatch(previous_seq, config.word_order)
        self._watch = HeartbeatWatch(config.heartbeat_timeout_s, self._lost)
        self._registers = RegisterFile(on_commit=self._committed, on_heartbeat=self._beaten)
        self._server = ModbusServer(
            Responder(self._registers, _IDENTITY),
            allowed_clients=config.allowed_clients,
            limits=limits,
        )
        self._intake = Intake(_QUEUE)
        self._worker: asyncio.Task[None] | None = None
        self._status = CellStatus()
        self._seq = 0
        self._heartbeat = 0

    @property
    def port(self) -> int:
        """The TCP port it listens on."""
        return self._server.port

    @property
    def line_alive(self) -> bool:
        """True while the PLC's heartbeat changes in time."""
        return self._watch.alive

    @property
    def counters(self) -> dict[str, int]:
        """Connections, requests and why connections ended, for the log."""
        return dict(self._server.counters)

    async def start(self) -> None:
        """Listen and take commands; raises ``PortInUse`` or ``CannotListen``."""
        self._refresh()
        await self._server.start(self._config.host, self._config.port)
        self._worker = asyncio.create_task(self._take_commands(), name="line commands")

    async def stop(self) -> None:
        """Drop the line. Idempotent."""
        self._watch.stop()
        if self._worker is not None:
            self._worker.cancel()
            await asyncio.gather(self._worker, return_exceptions=True)
            self._worker = None
        await self._server.stop()

    def publish(self, status: CellStatus) -> None:
        """Show a new snapshot, all of it or nothing."""
        self._status = status
        self._refresh()

    def beat(self) -> None:
        """Called by the state machine's task: the cell lives. Not while commands are not taken."""
        if self._worker is not None and not self._worker.done():
            self._heartbeat = (self._heartbeat + 1) & 0xFFFF
            self._refresh()

    def finish(self, seq: int, result: Result) -> bool:
        """A command has ended; False when a later one has already taken its place."""
        ended = self._latch.finish(seq, result)
        self._refresh()
        return ended

    async def failed(self) -> None:
        """Wait for the end of the command task; raises ``LineTaskDied`` unless it was stopped."""
        worker = self._worker
        if worker is None:
            return
        await asyncio.wait({worker})
        error = None if worker.cancelled() else worker.exception()
        if error is not None:
            raise LineTaskDied(f"{type(error).__name__}: {error}") from error

    def _committed(self) -> None:
        command = self._latch.commit(self._registers.holding)
        dropped = None if command is None else self._intake.add(command)
        if dropped is not None:
            self._supersede(dropped)
        self._refresh()

    def _beaten(self, value: int) -> None:
        if self._watch.seen(value):
            _log.info("line heartbeat present")
            self._refresh()

    def _lost(self) -> None:
        _log.warning("line heartbeat lost", timeout_s=self._config.heartbeat_timeout_s)
        self._refresh()
        self._on_plc_lost()

    async def _take_commands(self) -> None:
        while True:
            command = await self._intake.next()
            for earlier in self._intake.overtaken():
                self._supersede(earlier)
            self._latch.begin(command.seq)
            code = await self._take(command)
            if code is RejectCode.NONE:
                self._latch.accept(command.seq)
            else:
                self._latch.reject(command.seq, code)
            _log.info("line command", seq=command.seq, cmd=command.cntrl_cmd, reject=code.text)
            self._refresh()

    def _supersede(self, command: UnitCommand) -> None:
        self._latch.supersede(command.seq)
        _log.warning("line command superseded", seq=command.seq, cmd=command.cntrl_cmd)

    async def _take(self, command: UnitCommand) -> RejectCode:
        try:
            code = await self._judge(command)
            return code or await self._handler.obey(command)
        except CellError as error:
            _log.exception("line command failed", seq=command.seq, fault=str(error))
            return RejectCode.DEVICE_NOT_READY

    async def _judge(self, command: UnitCommand) -> RejectCode:
        if command.ends_motion:
            return RejectCode.NONE
        if not self._watch.alive:
            return RejectCode.LINE_HEARTBEAT_MISSING
        return command.judge() or await self._judge_unless_overtaken(command)

    async def _judge_unless_overtaken(self, command: UnitCommand) -> RejectCode:
        judging = asyncio.create_task(self._handler.judge(command), name="line command")
        urgent = asyncio.create_task(self._intake.urgent(), name="stop of the line")
        try:
            await asyncio.wait({judging, urgent}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            overtaken = urgent.done()
            for task in (judging, urgent):
                task.cancel()
            await asyncio.gather(judging, urgent, return_exceptions=True)
        return RejectCode.SUPERSEDED if overtaken else judging.result()

    def _refresh(self) -> None:
        self._seq = (self._seq + 1) & 0xFFFF
        latch = self._latch
        handshake = Handshake(
            ack_seq=latch.ack_seq,
            done_seq=latch.done_seq,
            result=latch.result,
            reject_code=latch.reject_code,
            cell_heartbeat=self._heartbeat,
            heartbeat_lost=self._watch.lost,
        )
        block = input_block(values(self._status, handshake, self._seq), self._config.word_order)
        self._registers.publish(block)
