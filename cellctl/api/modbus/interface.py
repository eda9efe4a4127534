"""The Modbus TCP interface to the line PLC: submits its commands, publishes the status, beats."""

import asyncio
import re
from collections.abc import Awaitable, Callable
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from typing import Any

from cellctl import log
from cellctl.api.modbus.encoding import Value, decode, input_block
from cellctl.api.modbus.heartbeat import LineHeartbeat
from cellctl.api.modbus.latch import CommandLatch
from cellctl.api.modbus.pdu import Responder
from cellctl.api.modbus.register_blocks import RegisterFile
from cellctl.api.modbus.register_map import HOLDING, INPUT, UNDEFINED_I32, Item, Kind
from cellctl.api.modbus.server import ModbusServer, ServerLimits
from cellctl.api.modbus.status import Handshake, values
from cellctl.api.modbus.submission import LineSubmission
from cellctl.clock import Monotonic, now_s
from cellctl.command.queue import CommandQueue
from cellctl.command.submission import NoteRefusal, Submit
from cellctl.config.cell import Plc
from cellctl.errors.base import CellError
from cellctl.errors.line import LineTaskDied
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.unit_command import UnitCommand
from cellctl.runtime.cell_status import CellStatus

_log = log.get(__name__)
_IDENTITY = ("cellctl", "cell controller", version("cellctl"))
_QUEUE_LIMIT = 16
"""Commands that wait. A PLC gives one and waits for its answer; this only bounds one that does
not."""
INPUT_TOPIC, HOLDING_TOPIC = "/registers/input", "/registers/holding"
_BEAT = "plc_heartbeat"
_RESTLESS = re.compile(r"seq_(head|tail)|cell_heartbeat|(mode|state)_time|refusal_\d+_age|test_.*")
"""Counters: they would make a message of every look."""
_RECORDED = tuple(
    item.name
    for item in INPUT
    if not (_RESTLESS.fullmatch(item.name) or item.name.startswith("spare"))
)


class PlcInterface:
    """Modbus TCP server with the register map and its handshake. Belongs to one event loop.

    Commands are submitted one after the other. Stop and Abort wait for no other command: they take
    the place of all that were not yet executed.
    """

    def __init__(
        self,
        config: Plc,
        submit: Submit,
        heartbeat: LineHeartbeat,
        remember_seq: Callable[[int], Awaitable[object]],
        *,
        note_refusal: NoteRefusal,
        previous_seq: int | None = None,
        limits: ServerLimits | None = None,
        given_s: Monotonic = now_s,
    ) -> None:
        """``heartbeat`` is fed here, and asked by whoever needs to know whether the line is alive.

        ``remember_seq`` writes the number of a command to disk; ``note_refusal`` hears of commands
        that are given up before they are submitted; ``previous_seq`` is the number that
        it wrote last before this start. ``given_s``: since when a command that is read now may have
        waited, monotonic time.
        """
        self._config = config
        self._submit = submit
        self._line_heartbeat = heartbeat
        self._remember_seq = remember_seq
        self._note_refusal = note_refusal
        self._given_s = given_s
        self._latch = CommandLatch(previous_seq, config.word_order)
        heartbeat.on_lost.append(self._lost)
        self._registers = RegisterFile(on_commit=self._committed, on_heartbeat=self._beaten)
        self._server = ModbusServer(
            Responder(self._registers, _IDENTITY),
            allowed_clients=config.allowed_clients,
            limits=limits,
            is_line=heartbeat.in_command,
        )
        self._queue: CommandQueue[LineSubmission] = CommandQueue(_QUEUE_LIMIT)
        self._worker: asyncio.Task[None] | None = None
        self._status = CellStatus()
        self._seq = 0
        self._beats = 0
        self._published = self._values()
        """What lies in the input registers, by name: published, shown and recorded are the same."""

    @property
    def port(self) -> int:
        """The TCP port it listens on."""
        return self._server.port

    @property
    def counters(self) -> dict[str, int]:
        """Connections, requests and why connections ended, for the log."""
        return dict(self._server.counters)

    def shown(self) -> list[dict[str, Any]]:
        """Every item of the map as it lies there now, for people.

        Items that the line writes have their words, which nobody has understood yet.
        """
        holding = self._registers.holding
        to_line = [_described(item, "cell", self._published[item.name]) for item in INPUT]
        from_line = [
            _described(item, "line", " ".join(str(holding[one]) for one in item.addresses))
            for item in HOLDING
        ]
        return [*to_line, *from_line]

    def recorded(self) -> dict[str, dict[str, Value]]:
        """Every register by name that says something of the run, by topic of a run's recording.

        Numbers as they lie in the registers, in the units of the register map; counters that change
        with every look are left out.
        """
        holding, order = self._registers.holding, self._config.word_order
        return {
            INPUT_TOPIC: {name: _plain(self._published[name]) for name in _RECORDED},
            HOLDING_TOPIC: {
                item.name: decode(item, holding, order) for item in HOLDING if item.name != _BEAT
            },
        }

    async def start(self) -> None:
        """Listen and submit commands; raises ``PortInUse`` or ``CannotListen``."""
        self._refresh()
        await self._server.start(self._config.host, self._config.port)
        self._worker = asyncio.create_task(self._submit_commands(), name="line commands")

    async def stop(self) -> None:
        """Drop all connections and submit nothing more. Idempotent."""
        self._line_heartbeat.stop()
        if self._worker is not None:
            self._worker.cancel()
            await asyncio.gather(self._worker, return_exceptions=True)
            self._worker = None
        await self._server.stop()

    @property
    def line_beat_age_s(self) -> float | None:
        """Since the heartbeat of the client in command has changed; None before that."""
        return self._line_heartbeat.age_s

    def publish(self, status: CellStatus) -> None:
        """Show a new snapshot, all of it or nothing."""
        self._status = status
        self._refresh()

    def beat(self) -> None:
        """Count the heartbeat of the cell; called by the task of the state machine.

        Does nothing once commands are no longer submitted: a PLC must not take a cell for alive
        that does not listen to it.
        """
        if self._worker is not None and not self._worker.done():
            self._beats = (self._beats + 1) & 0xFFFF
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

    def _committed(self, client: str) -> None:
        committed = self._latch.commit(self._registers.written_by(client), client)
        if committed is not None:
            seq, command = committed
            # Modbus knows no persons: the line is known by the address that it writes from.
            named = replace(command, person=client).given_at(self._given_s())
            dropped = self._queue.add(self._submission(seq, named, client))
            if dropped is not None:
                self._supersede(dropped)
        self._refresh()

    def _submission(self, seq: int, command: UnitCommand, client: str) -> LineSubmission:
        return LineSubmission(
            command,
            seq=seq,
            alive=partial(self._line_heartbeat.alive_of, client),
            remember_seq=self._remember_seq,
            stop_waits=self._queue.urgent,
            on_command=partial(self._line_heartbeat.commanded, client),
            on_end=self.finish,
        )

    def _beaten(self, client: str, value: int) -> None:
        if self._line_heartbeat.seen(client, value):
            _log.info("line heartbeat present", peer=client)
            self._refresh()

    def _lost(self) -> None:
        _log.warning("line heartbeat lost", timeout_s=self._config.heartbeat_timeout_s)
        self._refresh()

    async def _submit_commands(self) -> None:
        while True:
            submission = await self._queue.next()
            # A PLC waits for the answer to each number that it has written, those of commands
            # that a Stop has overtaken among them.
            for earlier in self._queue.overtaken():
                self._supersede(earlier)
            seq = submission.seq
            self._latch.begin(seq)
            code = await self._code(submission)
            if code is RejectCode.NONE:
                self._latch.accept(seq)
            else:
                self._latch.reject(seq, code)
            cmd = submission.command.cntrl_cmd
            _log.info("line command", seq=seq, cmd=cmd, reject=code.text)
            self._refresh()

    async def _code(self, submission: LineSubmission) -> RejectCode:
        """A fault has a number of its own among the alarms; the PLC still needs its answer."""
        try:
            return await self._submit(submission)
        except CellError as error:
            _log.exception("line command failed", seq=submission.seq, fault=str(error))
            return RejectCode.DEVICE_NOT_READY

    def _supersede(self, submission: LineSubmission) -> None:
        self._latch.supersede(submission.seq)
        cmd = submission.command.cntrl_cmd
        _log.warning("line command superseded", seq=submission.seq, cmd=cmd)
        self._note_refusal(submission.command, RejectCode.SUPERSEDED, submission.reference)

    def _refresh(self) -> None:
        # The same number at both ends of the block: a PLC that reads it in slices sees a tear.
        self._seq = (self._seq + 1) & 0xFFFF
        self._published = self._values()
        self._registers.publish(input_block(self._published, self._config.word_order))

    def _values(self) -> dict[str, Value]:
        latch = self._latch
        handshake = Handshake(
            ack_seq=latch.ack_seq,
            done_seq=latch.done_seq,
            result=latch.result,
            reject_code=latch.reject_code,
            cell_heartbeat=self._beats,
            heartbeat_lost=self._line_heartbeat.lost,
        )
        return values(self._status, handshake, self._seq)


def _described(item: Item, writer: str, value: Value) -> dict[str, Any]:
    return {
        "address": item.address,
        "name": item.name,
        "text": item.text,
        "unit": item.unit,
        "writer": writer,
        "value": None if item.kind is Kind.I32 and value == UNDEFINED_I32 else _plain(value),
    }


def _plain(value: Value) -> Value:
    """The value without the name that an enumeration gives to it."""
    return int(value) if isinstance(value, int) else value
