"""Step 30 over streamed contact with an elastic part; stream and sensor are of the test."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.errors.base import CellError
from cellctl.errors.force import ForceLimitExceeded
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.processes.peg_in_hole.cycle import CyclePlan
from cellctl.processes.peg_in_hole.faults import HoleAbsent, PegWedged
from cellctl.processes.peg_in_hole.offline.task_file import JudgedPart
from cellctl.processes.peg_in_hole.plan.choice import SearchName, choose_search
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.report.pages import pages
from cellctl.processes.peg_in_hole.run import PegFacts, PegRun
from cellctl.processes.peg_in_hole.search.face import FacePlan
from cellctl.processes.peg_in_hole.state import FaceTouched
from cellctl.processes.peg_in_hole.stations import peg_recipes
from cellctl.processes.peg_in_hole.steps import insert_peg
from cellctl.processes.peg_in_hole.verdict.judgement import PegSeatLimits
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import Artefact, RunRecord
from cellctl.records.report.sections import Drawing, FactList
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from cellctl.runtime.progress import ProgressBoard
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.bench import CELL_FILE
from tests.unit.cell.contact_motion.elastic_world import (
    FRAMES,
    ElasticWorld,
    Hole,
    Part,
    contact,
    wall,
)
from tests.unit.processes.peg_in_hole.record.test_tick_log import ticked
from tests.unit.processes.peg_in_hole.tasks import pin
from tests.unit.records.conftest import start

STIFFNESS_N_M = 1e5
(RECIPE,) = peg_recipes(shipped_cell("insertion-pin.toml"))


class Bench:
    """One run of the step; the record is a real one."""

    def __init__(self, folder: Path, part: Part, patch: pytest.MonkeyPatch) -> None:
        self.world = ElasticWorld(part, sigma_n=0.1)
        self.task = pin(
            0.05, chamfer_mm=0.5, stiffness_n_m=STIFFNESS_N_M,
            dead_time_s=self.world.dead_time_s, uncertainty_m=0.2e-3,
        )  # fmt: skip
        self.store = AsyncRunStore(folder)
        self.board = ProgressBoard()
        self.patch = patch

    async def run(self) -> RunRecord:
        recorder = RunRecorder(self.store, await self.store.do(start))
        facts = cast(
            PegFacts,
            SimpleNamespace(
                plan=planned(self.task), cell=SimpleNamespace(arm=self._arm()), recipe=RECIPE
            ),
        )
        self.patch.setattr(insert_peg, "contact", self._contact)
        touched = FaceTouched(PegRun(facts, self.board, recorder), FRAMES, 0.0)
        self.fault: CellError | None = None
        try:
            await insert_peg.find_and_insert(touched)
        except CellError as fault:
            self.fault = fault
        return await self.store.do(RunStore.run, recorder.run)

    def _arm(self) -> SimpleNamespace:
        sensor = shipped_cell(CELL_FILE.name).force_sensors["force"]
        return SimpleNamespace(guard=self.world.guard, sensor=sensor)

    @asynccontextmanager
    async def _contact(self, *_arguments: Any) -> AsyncIterator[StreamedContact]:
        yield contact(self.world, LoopFigures(STIFFNESS_N_M, self.world.dead_time_s))


def planned(task: SearchTask) -> CyclePlan:
    # One strategy will do: what comes of a search is asked here, not how it is made.
    choice = replace(choose_search(task), order=(SearchName.SPIRAL,))
    return CyclePlan(task, choice, PegSeatLimits(5.0, 35.0), FacePlan(8e-3, 3e-3), 200.0)


@pytest.mark.figures  # a whole search; the cycle ends alike in `test_cycle.py`
@pytest.mark.filterwarnings("error")
async def test_a_search_that_finds_no_hole_keeps_its_path_and_leaves_the_face(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = Bench(tmp_path, wall(STIFFNESS_N_M), monkeypatch)
    # A small region, which is soon searched.
    bench.task = replace(bench.task, cell=replace(bench.task.cell, uncertainty_m=0.05e-3))
    record = await bench.run()
    assert isinstance(bench.fault, HoleAbsent)
    assert len(record.document(keys.TRACE)["points"]) >= 1
    weights = np.array(record.document(keys.MAP)["weights"])
    assert weights.min() < 0.01 * weights.max()
    failure = record.document(keys.FAILURE)
    assert failure["found_by"] is None
    assert failure["fault"].startswith("F547")
    assert bench.world.tip[2] == pytest.approx(-10e-3, abs=0.1e-3)
    assert bench.board.current.message == "the peg was drawn out"
    drawn = pages(record, lambda _artefact: b"")
    assert [section.title for section in drawn.sections] == ["Search", "Insertion"]
    facts = [
        fact
        for block in drawn.sections[0].blocks
        if isinstance(block, FactList)
        for fact in block.facts
    ]
    assert "estimate, tilted-valley" in dict(facts), "why the other searches were not the first"
    ticks = ticked(20).text().encode()
    file = Artefact(record.head.started, keys.ticks(keys.INSERTION), "", len(ticks), "text/csv")
    kept = replace(record, artefacts=(file,))
    seen = pages(kept, lambda _artefact: ticks).sections[1].blocks
    over_depth, over_time = (block.svg for block in seen if isinstance(block, Drawing))
    assert "jam ratio" in over_depth
    assert "age, ms" in over_time


async def test_a_wedged_peg_is_left_where_it_stands_and_its_search_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hole = Hole(STIFFNESS_N_M, clearance_m=0.05e-3, chamfer_m=0.5e-3, depth_m=12e-3)
    bench = Bench(tmp_path, hole, monkeypatch)

    async def wedged(*_arguments: object, **_options: object) -> None:
        raise PegWedged("1.5 mm")

    monkeypatch.setattr("cellctl.processes.peg_in_hole.cycle.insert", wedged)
    record = await bench.run()
    assert isinstance(bench.fault, PegWedged)
    assert record.document(keys.FAILURE)["found_by"] == "spiral"
    assert record.document(keys.TRACE)["points"][-1]["felt"] == "entry"
    assert bench.world.tip[2] > bench.task.fit.entry_depth_m - 1e-4
    assert bench.board.current.message == "the peg is left where it stands"


async def test_a_peg_in_its_hole_is_recorded_with_its_search_which_the_guard_watched_closer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hole = Hole(STIFFNESS_N_M, clearance_m=0.05e-3, chamfer_m=0.5e-3, depth_m=12e-3)
    bench = Bench(tmp_path, hole, monkeypatch)
    bench.task = replace(bench.task, fit=replace(bench.task.fit, depth_m=12e-3))
    record = await bench.run()
    part = JudgedPart.model_validate(record.document(keys.TASK))
    assert part.cell.stiffness_n_mm == pytest.approx(STIFFNESS_N_M / 1e3)
    assert part.felt.greatest_n == pytest.approx(2.5 * bench.task.limits.search_n)
    assert not record.document(keys.FAILURE)
    assert record.document(keys.CYCLE)["found_by"] == "spiral"
    assert record.document(keys.TRACE)["points"][-1]["felt"] == "entry"
    assert keys.SEARCH_TIME in record.newest_figures
    # Closer while the peg searches than while it is fed.
    watched = [limits.filtered[0] for limits in bench.world.guard.limits]
    assert watched == [20.0, 20.0, 37.5, 37.5]
    # As the line is shown it.
    assert bench.board.current.force_limit_n == 37.5
    written = {one["name"]: one["value"] for one in record.document(keys.CHOICE)["guard"]}
    assert written["guard, search"] == 20.0
    assert written["guard, insert"] == 37.5


async def test_a_search_that_presses_too_hard_is_stopped_at_the_limit_of_the_search(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Ten times as stiff as the bounds of the cell say: a touch grows beyond what it may.
    bench = Bench(tmp_path, wall(10 * STIFFNESS_N_M), monkeypatch)
    bench.world.watches = True
    await bench.run()
    assert isinstance(bench.fault, ForceLimitExceeded)
    peak_n = float(np.abs(np.array(bench.world.forces)[:, :3]).max())
    assert 20.0 < peak_n < bench.task.limits.fault_n
