"""Start, supervise and end the daemon."""

import asyncio
import json
import signal
import sys
from collections.abc import Coroutine, Sequence
from contextlib import AsyncExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

from cellctl import log
from cellctl.api.local_socket.api import local_api
from cellctl.api.local_socket.live_feed import LiveFeed
from cellctl.api.modbus.heartbeat import LineHeartbeat
from cellctl.api.modbus.interface import PlcInterface
from cellctl.api.modbus.publisher import StatusPublisher
from cellctl.api.modbus.status import require_registers
from cellctl.calibration.store.validity import LOOK_S
from cellctl.cell.devices import Cell
from cellctl.cell.run_notes import RunNotes
from cellctl.command.arbiter import CommandArbiter
from cellctl.command.arrivals import ArrivalClock
from cellctl.config import CellConfig, load_cell
from cellctl.config.cell import Plc
from cellctl.daemon.heap import collect_what_comes, give_back_large_blocks, give_back_small_blocks
from cellctl.daemon.notify import notify
from cellctl.daemon.supervision import supervise
from cellctl.daemon.vitals import DaemonVitals
from cellctl.errors import CellError
from cellctl.errors.internal import Unexpected
from cellctl.packml.command import Command
from cellctl.packml.state import State
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore
from cellctl.runtime.background import Background
from cellctl.runtime.cell_status import CellStatus
from cellctl.runtime.unit import AT_REST, UnitController

_log = log.get(__name__)

SIGNALS = (signal.SIGINT, signal.SIGTERM)


@dataclass(frozen=True, slots=True)
class Overrides:
    """What the command line says in place of the cell file; None means as the cell file says."""

    data_dir: Path | None = None
    calibration_dir: Path | None = None
    modbus_port: int | None = None

    def of(self, config: CellConfig) -> CellConfig:
        """The cell file's content with these in place."""
        changes: dict[str, Any] = {}
        if self.modbus_port is not None:
            changes["plc"] = config.plc.model_copy(update={"port": self.modbus_port})
        if self.calibration_dir is not None:
            changes["calibration_dir"] = str(self.calibration_dir.absolute())
        return config.model_copy(update=changes)


async def serve(cell_file: Path, overrides: Overrides) -> int:
    """Run one cell until a signal; returns the exit code.

    Raises the numbered fault when the daemon cannot be started, or when a part of it dies. Devices
    that do not answer leave the unit Aborted, and Clear tries them again. However it ends, motion
    is stopped, an open run is closed as aborted and no child process is left.
    """
    config = overrides.of(load_cell(cell_file))
    give_back_large_blocks()
    stop, told = asyncio.Event(), list[str]()

    def tell(number: signal.Signals) -> None:
        told.append(number.name)
        stop.set()

    loop = asyncio.get_running_loop()
    for number in SIGNALS:
        loop.add_signal_handler(number, tell, number)
    # A terminal that is closed sends SIGHUP to every process of it. The helpers that
    # multiprocessing starts with ``Cell`` inherit that it is ignored, so that the daemon alone
    # answers and ends them in order; its own handler comes when they are there.
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    async with AsyncExitStack() as stack:
        data_dir = overrides.data_dir or Path(config.data_dir)
        store = AsyncRunStore(data_dir)
        # The stack unwinds from its end: arms first, links next, and last of all the store, because
        # everything before it still writes down how it ended.
        stack.callback(store.close)
        cell = _cell(config, cell_file.parent, data_dir)
        loop.add_signal_handler(signal.SIGHUP, tell, signal.SIGHUP)
        _load_children(cell, stack)
        unit = UnitController(cell, store)
        unit.calibrations.look_every(LOOK_S)
        unit.machine.on_change.append(partial(_tidy_at_rest, unit.background))
        stack.push_async_callback(unit.background.drain)
        log.always(unit.log_facts)
        # Before anybody can command: runs that an earlier process left open are closed as
        # interrupted, and its alarms are known again.
        await unit.open()
        arrivals = ArrivalClock()
        arbiter, plc = await _command_path(config.plc, unit, store, arrivals)
        vitals = DaemonVitals(lambda: plc.line_beat_age_s)
        local = local_api(
            cell,
            unit,
            arbiter,
            store,
            data_dir,
            registers=plc.shown,
            daemon=vitals.snapshot,
            given_s=arrivals.given_s,
        )
        publisher = StatusPublisher(unit, partial(_show, plc, local.feed, cell.run_notes))
        stack.push_async_callback(plc.stop)
        # Before any device is connected: the port is bound once on a PC, so a second daemon of the
        # same cell ends here and does not take over the robots.
        await plc.start()
        stack.push_async_callback(local.server.stop)
        await local.server.start()
        stack.push_async_callback(cell.disconnect)
        # The last thing on the stack is the first to happen: the arm is stopped while every link
        # still stands and the fault is known.
        stack.push_async_exit(partial(_end, unit, store, told))
        collect_what_comes()
        watches = supervise(cell, unit, plc, publisher, store, vitals=vitals, arrivals=arrivals)
        await until_told(stop, _work(cell, unit, watches, plc))
        _log.info("asked to end")
        notify("STOPPING=1")
    _log.info("ended")
    return 0


def _load_children(cell: Cell, stack: AsyncExitStack) -> None:
    stack.callback(cell.workers.close)
    # Guards load while the unit loads its processes. None opens its sensor before the devices are
    # connected, so that a second daemon of the same cell takes nothing from the first.
    for guard in cell.guards.values():
        guard.load()
        stack.push_async_callback(guard.stop)


def _tidy_at_rest(background: Background, _before: State, after: State) -> None:
    if after in AT_REST:
        # In a thread: the loop also beats for the guard and the line while the unit is at rest.
        background.start(asyncio.to_thread(give_back_small_blocks))


def _cell(config: CellConfig, folder: Path, data_dir: Path) -> Cell:
    """The devices; what has to outlive a restart is kept beside the records."""
    cell = Cell(config, folder)
    cell.zero_folder = data_dir / "zeros"
    return cell


async def _command_path(
    config: Plc, unit: UnitController, store: AsyncRunStore, arrivals: ArrivalClock
) -> tuple[CommandArbiter, PlcInterface]:
    """The arbiter of all commands and the interface to the line PLC, which is not yet listening.

    They share the line's heartbeat: the interface feeds it, and the arbiter asks it whether the
    line is in control.
    """
    require_registers(unit.calibrations.kinds)
    heartbeat = LineHeartbeat(config.heartbeat_timeout_s, unit.line_lost)
    arbiter = CommandArbiter(unit, store, line_alive=lambda: heartbeat.alive)
    plc = PlcInterface(
        config,
        arbiter.submit,
        heartbeat,
        lambda seq: store.do(RunStore.note_line_seq, seq),
        note_refusal=arbiter.note_refusal,
        previous_seq=await store.do(RunStore.line_seq),
        given_s=arrivals.given_s,
    )
    return arbiter, plc


def _show(plc: PlcInterface, feed: LiveFeed, notes: RunNotes, status: CellStatus) -> None:
    """Line and pages are shown the same snapshot: it is built once, and a run keeps it."""
    plc.publish(status)
    feed.publish(status)
    for topic, registers in plc.recorded().items():
        notes.tell(topic, registers)


async def until_told(stop: asyncio.Event, work: Coroutine[Any, Any, None]) -> None:
    """Wait for the signal; raises a numbered fault when a part of the daemon itself dies before."""
    try:
        async with asyncio.TaskGroup() as tasks:
            watcher = tasks.create_task(work)
            await stop.wait()
            watcher.cancel()
    except BaseExceptionGroup as group:
        raise _numbered(group) from group


def _numbered(error: BaseException) -> CellError:
    while isinstance(error, BaseExceptionGroup):
        # The first is the cause. A task group cancels all others because of it, and what they raise
        # on their way out says nothing more.
        error = error.exceptions[0]
    if isinstance(error, CellError):
        return error
    return Unexpected(f"{type(error).__name__} in the daemon: {error}")


async def _end(
    unit: UnitController,
    store: AsyncRunStore,
    told: Sequence[str],
    _kind: type[BaseException] | None,
    error: BaseException | None,
    _traceback: TracebackType | None,
) -> None:
    fault = error if isinstance(error, CellError) else None
    if fault is None and unit.machine.state not in AT_REST:
        # The run that is aborted now has no fault: its record says whose command it was.
        by = f"the end of the daemon ({told[0] if told else 'no signal'})"
        unit.background.start(store.do(RunStore.audit, by, Command.ABORT.name.lower()))
    await unit.close(fault)


async def _work(
    cell: Cell, unit: UnitController, supervision: Coroutine[Any, Any, None], plc: PlcInterface
) -> None:
    """Everything that goes on until the end, with the devices or without."""
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(supervision)
        await unit.come_up()
        # Also with devices that are off: the daemon itself is up and waits for Clear. Systemd would
        # start it again and again, and nobody could clear it.
        notify("READY=1")
        if not unit.live:
            _tell(cell, plc, ready=False, error=str(unit.machine.fault or "aborted"))
            await unit.until_live()
        _tell(cell, plc, ready=True)


def _tell(cell: Cell, plc: PlcInterface, **how: bool | str) -> None:
    """Systemd, the log, and whoever started the daemon."""
    name = cell.config.name
    status = "ready" if how["ready"] else f"waits for Clear: {how['error']}"
    _log.info(status, cell=name, modbus_port=plc.port)
    notify(f"STATUS={status}, Modbus TCP on port {plc.port}")
    # A program that has started the daemon reads one line of JSON; a person reads words.
    if sys.stdout.isatty():
        print(f"{name}: {status}. Modbus TCP on port {plc.port}; Ctrl-C ends the daemon.")
    else:
        json.dump({**how, "cell": name, "modbus_port": plc.port}, sys.stdout)
        print(flush=True)
