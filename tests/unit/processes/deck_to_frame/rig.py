"""A run of the assembly in memory: real steps, real recorder, a true world instead of pictures."""

from pathlib import Path
from typing import Any, cast

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.lighting.auto_exposure import RunExposures
from cellctl.force.contact.curve import ForceCurve, curve_statistics
from cellctl.force.contact.seat import SeatVerdict
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import MatingOutcome, MatingResult, Reading, Tare
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry, PartMeasurer
from cellctl.processes.deck_to_frame.recipe import PoseCorrection
from cellctl.processes.deck_to_frame.record.deck_recorder import DeckRecorder
from cellctl.processes.deck_to_frame.run import AssemblyRun, OpenRun
from cellctl.processes.deck_to_frame.state import Ready
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunRecord
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from cellctl.runtime.interruption import Interruption
from cellctl.runtime.progress import ProgressBoard
from cellctl.workers import VisionWorkers
from tests.unit.cell.bench import Bench, TruthMeasurer
from tests.unit.records.conftest import start


class Pauses:
    """A safe point that tells when it was asked, and holds where a test wants it to."""

    def __init__(self, held_at: tuple[int, ...] = ()) -> None:
        self.asked: list[bool] = []
        self._held_at = held_at

    async def __call__(self, *, hold: bool = False) -> bool:
        self.asked.append(hold)
        return hold or len(self.asked) in self._held_at


class RunRig:
    """One open run."""

    def __init__(self, bench: Bench, store: Path) -> None:
        self.bench = bench
        self.archive = AsyncRunStore(store)
        self.number = self.archive._thread.submit(lambda: start(self.archive._store)).result()
        self.pauses = Pauses()
        bench.cell.workers.answers["draw"] = lambda *_: b"picture"
        self.board = ProgressBoard()
        workers = cast(VisionWorkers, bench.cell.workers)
        self.recorder = DeckRecorder(RunRecorder(self.archive, self.number), workers)
        geometry = bench.geometry()
        heads = HeadGeometry.of(geometry, PoseCorrection())
        self.truth = TruthMeasurer(bench, heads, geometry.base_T_c1.pose)

    def run(self, **changes: Any) -> AssemblyRun:
        """A run with changes of its facts."""
        opened = OpenRun(
            self.bench.facts(**changes),
            self.board,
            self.recorder,
            self.pauses,
            Interruption(),
            RunExposures(self.bench.as_cell, self.recorder.recorder),
        )
        return AssemblyRun(opened, cast(PartMeasurer, self.truth))

    def ready(self, **changes: Any) -> Ready:
        """The state before the first step."""
        return Ready(self.run(**changes))

    async def record(self) -> RunRecord:
        return await self.archive.do(RunStore.run, self.number)

    @property
    def true_deck(self) -> RigidTransform:
        """``M_T_D`` as it really is."""
        world, flange = self.bench.world, self.bench.cell.main.flange
        return world.base_T_frame.inv() * flange * world.robot_error * world.flange_T_deck


def curve(samples: int = 50, force_n: float = 36.0) -> ForceCurve:
    time_s = np.arange(samples, dtype=np.float64) * 1e-3
    wrench = np.zeros((samples, 6))
    wrench[:, 2] = np.linspace(0.0, force_n, samples)
    return ForceCurve(time_s, wrench, np.linspace(0.0, 0.01, samples))


def seated(plan: MatingPlan) -> MatingResult:
    reading = Reading(1.0, 0.01, np.array([1.0, 0, 36.0, 0, 0, 0]), np.full(6, 0.3))
    released = Reading(2.0, 0.0098, np.array([0.5, 0, 15.0, 0, 0, 0]), np.full(6, 0.3))
    felt = curve()
    return MatingResult(
        outcome=MatingOutcome.SEATED,
        window=plan.window,
        speed=plan.speed,
        segment_m=plan.segment_m,
        tare=Tare(np.zeros(6), np.ones(6)),
        touch_travel_m=0.01,
        touch_force_n=12.0,
        creep=(reading,),
        stiffness=None,
        hold=reading,
        verdict=SeatVerdict(36.0, 1e-5, 1.0, 0.5, ()),
        relaxing=(released,),
        gave_way=(),
        curve=felt,
        statistics=curve_statistics(felt.time_s, felt.wrench),
        duration_s=20.0,
    )
