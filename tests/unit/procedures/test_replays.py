"""Recorded procedures are computed anew: the same figures, or by how much they differ."""

import asyncio
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation
from typer.testing import CliRunner

from cellctl.calibration.boards.board import BoardView
from cellctl.calibration.boards.board_images import BoardImages
from cellctl.calibration.boards.board_pose import target_board_discs
from cellctl.calibration.checks import LimitCheck, evidence_to_record
from cellctl.cli.commands import whole_app
from cellctl.clock import now_s
from cellctl.errors import CellError
from cellctl.errors.records.store import NotReplayable
from cellctl.geometry.pose import Array, pose_from_xyzabc
from cellctl.guard.report import GuardSample, GuardSamples
from cellctl.interfaces import StereoPair
from cellctl.procedures import replays, stop_latency
from cellctl.procedures.payload import Stillness, identify_payload_on_cell
from cellctl.procedures.stop_latency_result import TimedStop
from cellctl.procedures.target_board import board_discs
from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    PAYLOAD,
    STEREO_HEAD_1,
    STEREO_HEAD_2,
)
from cellctl.processes.deck_to_frame.process import DeckToFrame
from cellctl.records.entries import Artefact, Document, RunRecord, RunResult
from cellctl.records.files.raw_images import MEDIA_TYPE, decode
from cellctl.records.replay.recorded_run import PROCEDURE_INPUT, RecordedRun
from cellctl.records.replay.replayed import Replayed
from cellctl.records.store import RunStore
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from tests.rigs.calibration.drawn_discs import drawn_discs
from tests.rigs.payload_world import LoadedSensor
from tests.rigs.raw_images import coded
from tests.unit.cell.guard import TinyGuard
from tests.unit.cell.robots import StillRobot
from tests.unit.procedures.large_field import Field, Watching
from tests.unit.procedures.rig import ProcedureRig


async def recorded(rig: ProcedureRig, number: int) -> RecordedRun:
    """A procedure as a job, to its end; its closed run."""
    job = rig.job(number)
    await job.start()
    fault: CellError | None = None
    try:
        await job.execute()
    except CellError as error:
        fault = error
    await job.close(RunResult.ABORTED if fault else RunResult.GOOD, fault)

    def read(store: RunStore) -> RecordedRun:
        calibrations = {one.id: one for one in store.calibrations()}
        files = {one.sha256: store.artefacts.get(one.sha256) for one in record(store).artefacts}
        return RecordedRun(record(store), lambda one: files[one.sha256], calibrations)

    def record(store: RunStore) -> RunRecord:
        return store.run(job.run_number)

    return await rig.archive.do(read)


async def told(rig: ProcedureRig, run: RecordedRun, *options: str) -> tuple[int, str]:
    """Exit code and words of the command."""
    arguments = ["replay", str(run.record.head.number), "--data-dir", str(rig.archive.path)]
    runner = CliRunner(env={"COLUMNS": "200", "NO_COLOR": "1"})
    result = await asyncio.to_thread(runner.invoke, whole_app(), [*arguments, *options])
    return result.exit_code, result.stdout or str(result.exception)


async def comes_out_the_same(rig: ProcedureRig, run: RecordedRun) -> str:
    code, said = await told(rig, run, "--every")
    assert code == 0, said
    counted = re.search(r"(\d+) of (\d+) numbers are identical", said)
    assert counted is not None
    assert counted[1] == counted[2] != "0"
    return said


def again(run: RecordedRun) -> list[Replayed]:
    return list(DeckToFrame.procedure_replays()[run.record.head.recipe_id](run))


def differing(run: RecordedRun) -> dict[str, float]:
    """Difference by measurement and name, of what is not the same."""
    lines = (line for line in again(run) if not line.identical)
    return {f"{line.measurement}: {line.name}": line.difference for line in lines}


def with_input(run: RecordedRun, change: Callable[[dict[str, Any]], None]) -> RecordedRun:
    """The run as if other readings had been recorded."""
    content = dict(run.input)
    change(content)
    changed = Document(PROCEDURE_INPUT, content)
    return replace(run, record=replace(run.record, documents=(*run.record.documents, changed)))


def with_files(run: RecordedRun, name: str, change: Callable[[bytes], bytes]) -> RecordedRun:
    """The run as if other bytes had been recorded in the files that have this in their names."""

    def read(artefact: Artefact) -> bytes:
        data = run.read(artefact)
        return change(data) if name in artefact.name else data

    return replace(run, read=read)


def moved(pixels: int) -> Callable[[bytes], bytes]:
    """An image whose content lies so far to the right."""

    def change(data: bytes) -> bytes:
        return coded(np.roll(decode(data), pixels, axis=1))

    return change


# -- 103, 109: the large-field head and the arm ----------------------------------------------------
@pytest.fixture
def watching(rig: ProcedureRig) -> Watching:
    return Watching(rig)


async def test_a_base_frame_and_its_check(rig: ProcedureRig, watching: Watching) -> None:
    run = await recorded(rig, 103)
    said = await comes_out_the_same(rig, run)
    for number in ("A1 residual rms", "c_T_base.matrix_mm.1.4", "reference.targets.1.position_mm"):
        assert number in said, number

    def raise_a_target(given: dict[str, Any]) -> None:
        given["a2_stops"][3]["targets"][0]["position_m"][2] += 1e-4

    found = differing(with_input(run, raise_a_target))
    assert found["base_frame: residuals_mm.A2 4:F1"] == pytest.approx(0.1, rel=0.3)
    assert found["base_frame: A2 residual rms"] > 0.0
    assert "base_frame: A1 residual rms" not in found, "nothing of this axis has changed"

    check = await recorded(rig, 109)
    assert "distance of target F3 from its place" in await comes_out_the_same(rig, check)

    def push_a_target(given: dict[str, Any]) -> None:
        given["now"]["targets"][2]["position_m"][0] += 1e-3

    off = differing(with_input(check, push_a_target))
    assert list(off) == ["targets: distance of target F3 from its place"]
    assert next(iter(off.values())) == pytest.approx(1.0, rel=0.2)


async def test_a_result_that_did_not_pass_is_held_against_its_figures(
    rig: ProcedureRig, watching: Watching
) -> None:
    """It is put aside and not stored: nothing but the checks is in its run."""
    watching.scatter_m = 1e-3
    run = await recorded(rig, 103)
    assert run.record.head.fault_number == 614
    said = await comes_out_the_same(rig, run)
    assert "A2 residual rms" in said
    assert "c_T_base" not in said


# -- 106: the payload ------------------------------------------------------------------------------
@dataclass
class Scale(TinyGuard):
    """A force sensor with a load, which samples every millisecond whether it is asked or not."""

    robot: StillRobot = field(default_factory=lambda: StillRobot("none"))
    load: LoadedSensor = field(default_factory=lambda: LoadedSensor(noise=np.full(6, 0.02)))
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))
    kept_s: list[float] = field(default_factory=lambda: [now_s()])
    kept: list[Array] = field(default_factory=lambda: [np.zeros(6)])

    def samples(self, since_s: float) -> GuardSamples:
        self._sample()
        later = np.array(self.kept_s) > since_s
        raw = np.array(self.kept)[later]
        return GuardSamples(
            np.array(self.kept_s)[later], raw, raw, np.zeros(len(raw)), overrun=False
        )

    def latest(self) -> GuardSample:
        self._sample()
        return GuardSample(self.kept_s[-1], self.kept_s[-1], 1, self.kept[-1], self.kept[-1], 0.01)

    def _sample(self) -> None:
        count = int((now_s() - self.kept_s[-1]) / 1e-3)
        if count > 0:
            turned = Rotation.concatenate([self.robot.flange.rotation] * count)
            self.kept_s.extend((self.kept_s[-1] + 1e-3 * np.arange(1, count + 1)).tolist())
            self.kept.extend(self.load.read(turned, self.rng))


@pytest.fixture
async def weighed(rig: ProcedureRig) -> RecordedRun:
    cell, arm = rig.bench.cell, rig.bench.cell.main
    cell.guard = arm.watched_by = cell.guards["force"] = scale = Scale(robot=arm)
    scale.armed = True

    async def weigh(context: ProcedureContext) -> ProcedureOutcome:
        return await identify_payload_on_cell(
            context, rig.bench.deck.arm, cell.workers,  # type: ignore[arg-type]
            pose_count=12, cone_deg=12.0, kind=PAYLOAD, stillness=Stillness(0.0, 0.02),
        )  # fmt: skip

    rig.answer(residual_picture=lambda _: b"png")
    rig.procedures[106] = replace(rig.procedures[106], run=weigh)
    return await recorded(rig, 106)


async def test_a_payload_from_the_samples_of_its_poses(
    rig: ProcedureRig, weighed: RecordedRun
) -> None:
    assert len(weighed.input["poses"]) == 12
    said = await comes_out_the_same(rig, weighed)
    for number in ("pose 12", "samples", "mz_n_m", "rigid12.mass_kg", "hold-out"):
        assert number in said, number


async def test_another_mean_of_a_pose_is_seen_in_the_payload(weighed: RecordedRun) -> None:
    def press(given: dict[str, Any]) -> None:
        given["poses"][0]["force_n"][2] += 5.0

    found = differing(with_input(weighed, press))
    assert found["pose 1: fz_n"] == pytest.approx(-5.0, abs=1e-3), "the samples are those they were"
    assert abs(found["payload: rigid12.mass_kg"]) > 1e-3


async def test_samples_that_are_others_are_found(weighed: RecordedRun) -> None:
    def pushed(given: dict[str, Any]) -> None:
        given["sensor"] = "another"

    lost = differing(with_input(weighed, pushed))
    count = weighed.input["poses"][4]["samples"]
    assert lost["pose 5: samples"] == -count
    pose = weighed.input["poses"][4]

    def later(given: dict[str, Any]) -> None:
        given["poses"][4]["to_s"] = (pose["from_s"] + pose["to_s"]) / 2

    fewer = differing(with_input(weighed, later))
    assert -count < fewer["pose 5: samples"] < 0
    assert 1e-4 < abs(fewer["pose 5: fz_n"]) < 0.1


# -- 107: the stop latency -------------------------------------------------------------------------
def stops() -> tuple[TimedStop, ...]:
    """An arm that goes on for 0.21 s, less or more by some milliseconds."""
    rng = np.random.default_rng(0)
    made = []
    for speed_m_s in np.repeat([2e-3, 4e-3, 6e-3, 8e-3], 3):
        age_s = float(rng.uniform(0.0, 0.02))
        start_m = np.array([1.5, 0.1, 1.6])
        up_m = np.array([0.0, 0.0, 1.0])
        seen_m = start_m + speed_m_s * up_m
        way_m = speed_m_s * (age_s + 0.21 + float(rng.normal(0.0, 2e-3)))
        made.append(TimedStop(float(speed_m_s), start_m, seen_m, age_s, seen_m + way_m * up_m))
    return tuple(made)


async def test_a_stop_latency_from_its_stops(
    rig: ProcedureRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def timed(*_of: object) -> Sequence[TimedStop]:
        return stops()

    monkeypatch.setattr(stop_latency, "timed_stops", timed)
    rig.answer(latency_picture=lambda *_: b"png")
    run = await recorded(rig, 107)
    said = await comes_out_the_same(rig, run)
    assert "upper bound" in said
    assert "overruns_mm.12" in said

    def ran_on(given: dict[str, Any]) -> None:
        given["stops"][11]["end_m"][2] += 1e-4

    found = differing(with_input(run, ran_on))
    assert found["stop_latency: overruns_mm.12"] == pytest.approx(0.1)
    assert found["stop_latency: latency_ms"] > 1.0
    assert "stop_latency: overruns_mm.11" not in found


# -- 104, 105: the target board --------------------------------------------------------------------
class BoardBefore:
    """A head before which the board lies, drawn as it sees it."""

    def __init__(self, rig: ProcedureRig, head: str, model: Any, place: RigidTransform) -> None:
        self._left, self._right = drawn_discs(model, place, board_discs())
        rig.bench.cell.stereo_cameras[head].grab = self._grab  # type: ignore[method-assign]

    async def _grab(self) -> StereoPair:
        return StereoPair(self._left, self._right, now_s(), 1)


@pytest.fixture
async def boards(rig: ProcedureRig) -> tuple[RecordedRun, RecordedRun]:
    """104 and 105, each with its board some millimetres beside the drawing."""
    store, told_there = rig.bench.calibrations, rig.bench.settings.flange_T_target_board
    c_T_base = store.read(BASE_FRAME).c_T_base.pose
    field_ = Field.of(rig)
    rig.answer(transfer_picture=lambda _: b"png")
    runs = []
    for number, head, kind in ((104, "head_1", STEREO_HEAD_1), (105, "head_2", STEREO_HEAD_2)):
        station = rig.bench.cell.stereo_station(head)
        beside = pose_from_xyzabc([2.0, -1.0, 1.5, 0.3, 0.2, -0.1])
        head_T_board = station.flange_T_head.inv() * pose_from_xyzabc(told_there) * beside
        BoardBefore(rig, head, store.read(kind).head, head_T_board)
        c_T_board = c_T_base * pose_from_xyzabc([1700, -400, 950, 90, 5, 178]) * head_T_board
        places = target_board_discs().items()
        field_.see({name: c_T_board.apply(place) for name, place in places})
        runs.append(await recorded(rig, number))
    return runs[0], runs[1]


async def test_a_board_is_computed_anew_from_its_images_and_one_that_was_late_is_told(
    rig: ProcedureRig, boards: tuple[RecordedRun, RecordedRun]
) -> None:
    first, _ = boards
    images = [one.name for one in first.record.artefacts if one.media_type == MEDIA_TYPE]
    assert sorted(images) == [
        f"raw/board-{number}-frame-1-head_1-{side}.pgm.zst"
        for number in range(1, 5)
        for side in ("left", "right")
    ]
    said = await comes_out_the_same(rig, first)
    assert "board in the head" in said
    assert "board in the large-field head" in said
    assert "board_transfer" not in said, "the other head was still to come"

    there = [one for one in first.record.artefacts if "board-3" not in one.name]
    lacking = replace(first, record=replace(first.record, artefacts=tuple(there)))
    with pytest.raises(NotReplayable, match=r"raw/board-3-frame-1-head_1-left.* and 1 more"):
        again(lacking)


@pytest.mark.figures  # the boards of the other head, twice
async def test_a_transfer_by_boards_is_computed_anew(
    rig: ProcedureRig, boards: tuple[RecordedRun, RecordedRun]
) -> None:
    _, second = boards
    assert "C1_T_C2 position sigma" in await comes_out_the_same(rig, second)

    # With a pixel of disparity the board is about a millimetre nearer.
    found = differing(with_files(second, "head_2-left", moved(1)))
    assert 0.1 < abs(found["board in the head: Z"]) < 5.0
    assert abs(found["board_transfer: board rms, small-field heads"]) > 1e-5
    assert not any(name.startswith("board in the large-field head") for name in found)


# -- 101, 102: the cameras of a head ---------------------------------------------------------------
class Brightness:
    """Stands in for detection and adjustment, which take a minute: they see how bright images
    are, and no board in dark ones."""

    @staticmethod
    def detect_view(images: BoardImages, _board: object) -> BoardView | None:
        brightness = float(images.left.mean()), float(images.right.mean())
        return None if brightness[0] < 5 else BoardView(images.name, *brightness)  # type: ignore[arg-type]

    @staticmethod
    def calibrate_stereo(views: Sequence[BoardView], _board: object, size: object) -> Any:
        figures = {view.name: [view.left, view.right] for view in views}
        mean = float(np.mean(list(figures.values())))
        evidence = evidence_to_record("brightness", (LimitCheck("mean", mean, 255.0, "grey"),))
        record: Mapping[str, Any] = {**evidence, "views": figures, "image_size": size}
        return SimpleNamespace(to_record=lambda: record, passed=True, warnings=())


@pytest.fixture
async def head(rig: ProcedureRig, monkeypatch: pytest.MonkeyPatch) -> RecordedRun:
    sees = Brightness()
    rig.answer(
        detect_view=sees.detect_view,
        calibrate_stereo=sees.calibrate_stereo,
        stereo_picture=lambda _: b"png",
    )
    monkeypatch.setattr(replays, "detect_view", sees.detect_view)
    monkeypatch.setattr(replays, "calibrate_stereo", sees.calibrate_stereo)
    return await recorded(rig, 101)


async def test_cameras_are_computed_anew_from_all_their_images(
    rig: ProcedureRig, head: RecordedRun
) -> None:
    images = [one for one in head.record.artefacts if one.media_type == MEDIA_TYPE]
    assert len(images) == 2 * rig.bench.settings.stereo_views
    said = await comes_out_the_same(rig, head)
    assert "views.view 24.2" in said

    def brighter(data: bytes) -> bytes:
        return coded(decode(data) + np.uint8(2))

    found = differing(with_files(head, "raw/view-7-frame-1-head_1-right.pgm.zst", brighter))
    assert found == {
        "head_1: views.view 7.2": pytest.approx(2.0),
        "head_1: mean": pytest.approx(2.0 / 48),
    }


# -- what cannot be computed anew ------------------------------------------------------------------
async def test_a_run_that_ended_before_it_had_measured_says_so(
    rig: ProcedureRig, watching: Watching
) -> None:
    rig.bench.cell.main.faults["move"] = NotReplayable("a fault of the arm")
    code, said = await told(rig, await recorded(rig, 103))
    assert code == 1
    assert "F813" in said
    assert "has no readings: it ended before all of them were taken" in said


async def test_a_calibration_that_is_not_in_the_store_any_more(
    rig: ProcedureRig, watching: Watching
) -> None:
    run = replace(await recorded(rig, 103), calibrations={})
    with pytest.raises(NotReplayable, match="base_frame of this run is not in the store"):
        again(run)


def test_each_procedure_of_the_cell_brings_its_recomputation(rig: ProcedureRig) -> None:
    kept_by_the_process = {one.number for one in rig.procedures.values() if one.opens_record}
    assert set(DeckToFrame.procedure_replays()) == set(rig.procedures) - kept_by_the_process
