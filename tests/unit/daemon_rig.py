"""The daemon's unit and line around a cell in memory; only vision and contact are stood in for."""

import asyncio
import importlib
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.api.modbus.interface import PlcInterface
from cellctl.api.modbus.publisher import StatusPublisher
from cellctl.clock import now_s
from cellctl.command.arbiter import DISK_TIMEOUT_S, CommandArbiter
from cellctl.command.arrivals import ArrivalClock
from cellctl.command.submission import Submission
from cellctl.daemon.supervision import supervise
from cellctl.daemon.vitals import DaemonVitals
from cellctl.errors import CellError
from cellctl.errors.line import LineLostInContact
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.packml.unit_command import Source, UnitCommand
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress, MatingResult
from cellctl.processes.deck_to_frame.moves import move_to_start as beginning
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunHead, RunRecord
from cellctl.records.store import RunStore
from cellctl.runtime.cell_status import CellStatus
from cellctl.runtime.interruption import Interruption
from cellctl.runtime.unit import UnitController
from tests.rigs.waiting import until
from tests.unit.cell.bench import Bench, TruthMeasurer, start_command
from tests.unit.processes.deck_to_frame.rig import curve, seated

WAIT_S = 60.0
"""Time for what has to come: long, since only a test that fails waits for it to its end."""
BY_ANNA: dict[str, Any] = {"source": Source.TERMINAL, "person": "anna"}


class PaperPort:
    """What the line would see."""

    def __init__(self) -> None:
        self.status = CellStatus()
        self.ended: dict[int, Result] = {}
        self.beats = 0
        self.line_alive = False

    def publish(self, status: CellStatus) -> None:
        self.status = status

    def beat(self) -> None:
        self.beats += 1


@dataclass(frozen=True, slots=True, eq=False)
class RigSubmission(Submission):
    """A command of the line with its number; the line's heartbeat is not asked for."""

    seq: int
    rig: "DaemonRig"

    @property
    def reference(self) -> dict[str, int]:
        return {"seq": self.seq}

    async def remember(self) -> None:
        await self.rig.archive.do(RunStore.note_line_seq, self.seq)

    def ended(self, result: Result) -> None:
        self.rig.port.ended[self.seq] = result


class Contact:
    """Takes the deck to its seat without feeling anything; a test may stop it there."""

    def __init__(self) -> None:
        self.reached = asyncio.Event()
        self.may_end = asyncio.Event()
        self.may_end.set()
        self.matings = 0
        self.fault: Exception | None = None
        self.interruptible = True
        self.interrupted_by: CellError | None = None
        self.flange: RigidTransform | None = None
        """Where the arm presses."""

    async def __call__(
        self,
        robot: Any,
        guard: Any,
        measured_plan: Any,
        report: Any,
        *,
        max_tries: int,
        interruption: Interruption,
    ) -> MatingResult:
        mating = self._mate(robot, measured_plan, report)
        if not self.interruptible:
            return await mating
        try:
            return await interruption.unless(mating)
        except LineLostInContact as fault:
            self.interrupted_by = fault
            raise

    async def _mate(self, robot: Any, measured_plan: Any, report: Any) -> MatingResult:
        plan = await measured_plan(1)
        self.matings += 1
        report(MatingProgress(MatingPhase.ENDED, 0.01, 36.0, curve=curve()))
        robot.flange = self.flange = plan.pose_at(plan.window.expected_m)
        self.reached.set()
        await self.may_end.wait()
        if self.fault is not None:
            raise self.fault
        return seated(plan)


class DaemonRig:
    """Unit, arbiter and archive."""

    def __init__(self, bench: Bench, store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.bench = bench
        self.contact = Contact()
        self.measurers: list[TruthMeasurer] = []
        bench.cell.workers.answers["draw"] = lambda *_: b"picture"
        monkeypatch.setattr(beginning, "PartMeasurer", self._measurer)
        module = importlib.import_module("cellctl.processes.deck_to_frame.steps.mate_deck")
        monkeypatch.setattr(module, "mate_until_seated", self.contact)
        self.store_folder = store
        self.ahead_s = 0.0
        """How much later it is for whoever asks for the status."""
        self._seq = 0

    async def open(self) -> None:
        """Open the unit as a daemon does that starts on this store."""
        self.archive = AsyncRunStore(self.store_folder)
        self.unit = UnitController(
            self.bench.as_cell, self.archive, clock=lambda: now_s() + self.ahead_s
        )
        self.port = PaperPort()
        self.arbitrate()
        self.publisher = StatusPublisher(self.unit, self.port.publish)
        await self.unit.open()
        await self.unit.come_up()
        self.states: list[State] = []
        self.unit.machine.on_change.append(self._changed)

    def arbitrate(self, disk_timeout_s: float = DISK_TIMEOUT_S) -> None:
        """Submit to a new arbiter from now on."""
        self.arbiter = CommandArbiter(
            self.unit,
            self.archive,
            line_alive=lambda: self.port.line_alive,
            disk_timeout_s=disk_timeout_s,
        )

    async def close(self) -> None:
        await self.unit.close()
        self.archive.close()

    async def restart(self) -> None:
        await self.close()
        await self.open()

    async def take(self, command: Command, **fields: Any) -> RejectCode:
        """A command of the line with the next number."""
        fields = {"recipe_id": 1, "unit_mode": 0} | fields
        return await self.submit(start_command(cntrl_cmd=command, **fields))

    async def ask(self, command: Command, **fields: Any) -> RejectCode:
        """A command of Anna at the terminal."""
        fields = {"recipe_id": 1, "unit_mode": 0} | BY_ANNA | fields
        return await self.submit(start_command(cntrl_cmd=command, **fields))

    async def submit(self, command: UnitCommand) -> RejectCode:
        """Any command; one of the line gets the next number."""
        if command.source is not Source.LINE:
            return await self.arbiter.submit(Submission(command))
        self._seq += 1
        return await self.arbiter.submit(RigSubmission(command, self._seq, self))

    def supervision(self, port: PaperPort) -> Coroutine[Any, Any, None]:
        """What the daemon watches until its end, with this port of the line."""
        return supervise(
            self.bench.as_cell,
            self.unit,
            cast(PlcInterface, port),
            self.publisher,
            self.archive,
            vitals=DaemonVitals(lambda: None),
            arrivals=ArrivalClock(),
        )

    async def to(self, *states: State) -> State:
        return await self.unit.machine.wait_for(*states, timeout_s=WAIT_S)

    async def idle(self) -> None:
        """Bring the unit to Idle from wherever it rests."""
        if self.unit.machine.state is State.ABORTED:
            assert await self.take(Command.CLEAR) is RejectCode.NONE
            await self.to(State.STOPPED)
        if self.unit.machine.state is not State.IDLE:
            assert await self.take(Command.RESET) is RejectCode.NONE
            await self.to(State.IDLE)

    async def started(self, **fields: Any) -> int:
        """Idle, then Start is taken; its number."""
        await self.idle()
        assert await self.take(Command.START, **fields) is RejectCode.NONE
        return self._seq

    async def until(self, condition: Callable[[], bool]) -> None:
        await until(condition, WAIT_S)

    async def runs(self) -> list[RunHead]:
        await self.unit.background.drain()
        return await self.archive.do(RunStore.runs)

    async def record(self, number: int = 1) -> RunRecord:
        await self.unit.background.drain()
        return await self.archive.do(RunStore.run, number)

    def shown(self) -> CellStatus:
        self.publisher.publish()
        return self.port.status

    def _measurer(
        self, cell: object, geometry: HeadGeometry, method: str, exposures: object
    ) -> TruthMeasurer:
        self.measurers.append(TruthMeasurer(self.bench, geometry, self.bench.base_T_c1()))
        return self.measurers[-1]

    def _changed(self, before: State, after: State) -> None:
        if before is not after:
            self.states.append(after)
