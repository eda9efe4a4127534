"""The line's side of the daemon: takes commands, publishes the state, watches heartbeats."""

import asyncio
from collections.abc import Awaitable, Callable
from importlib.metadata import version

from cellctl import log
from cellctl.config.cell import Plc
from cellctl.errors.base import CellError
from cellctl.errors.line import LineTaskDied
from cellctl.packml.reject import RejectCode
from cellctl.plc.commands import CommandLatch, LineCommand
from cellctl.plc.heartbeat import HeartbeatWatch
from cellctl.plc.image import input_block
from cellctl.plc.pdu import Responder
from cellctl.plc.registers import RegisterFile
from cellctl.plc.result import Result
from cellctl.plc.server import ModbusServer, ServerLimits
from cellctl.plc.status import CellStatus, Handshake, values

OnCommand = Callable[[LineCommand], Awaitable[RejectCode]]

_log = log.get(__name__)
_IDENTITY = ("cellctl", "cell controller", version("cellctl"))
_QUEUE = 16


class PlcPort:
    """Modbus TCP server with the register map and its handshake.

    ``on_command`` answers quickly whether a command begins; whoever carries it out calls
    ``finish`` with the same number at its end. Lives in one event loop.
    """

    def __init__(
        self,
        config: Plc,
        on_command: OnCommand,
        on_plc_lost: Callable[[], None],
        *,
        previous_seq: int | None = None,
        limits: ServerLimits | None = None,
    ) -> None:
        """``previous_seq``: number of the last command before this start, from the run store."""
        self._config = config
        self._on_command = on_command
        self._on_plc_lost = on_plc_lost
        self._latch = CommandLatch(previous_seq, config.word_order)
        self._watch = HeartbeatWatch(config.heartbeat_timeout_s, self._lost)
        self._registers = RegisterFile(on_commit=self._committed, on_heartbeat=self._beaten)
        self._server = ModbusServer(
            Responder(self._registers, _IDENTITY),
            allowed_clients=config.allowed_clients,
            limits=limits,
        )
        self._queue: asyncio.Queue[LineCommand] = asyncio.Queue(_QUEUE)
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
        if command is not None:
            if self._queue.full():
                dropped = self._queue.get_nowait()
                _log.warning("line commands faster than they can be taken", dropped=dropped.seq)
            self._queue.put_nowait(command)
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
            command = await self._queue.get()
            self._latch.begin(command.seq)
            code = await self._decide(command)
            if code is RejectCode.NONE:
                self._latch.accept(command.seq)
            else:
                self._latch.reject(command.seq, code)
            _log.info("line command", seq=command.seq, cmd=command.cntrl_cmd, reject=code.text)
            self._refresh()

    async def _decide(self, command: LineCommand) -> RejectCode:
        if not (command.ends_motion or self._watch.alive):
            return RejectCode.LINE_HEARTBEAT_MISSING
        code = command.judge()
        if code is not RejectCode.NONE:
            return code
        try:
            return await self._on_command(command)
        except CellError as error:
            _log.exception("line command failed", seq=command.seq, fault=str(error))
            return RejectCode.DEVICE_NOT_READY

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
