"""A procedure as a job: what is kept, what is put aside, and what the audit log says."""

import json
from dataclasses import replace
from datetime import timedelta

import pytest

from cellctl.calibration.store.envelope import read_calibration
from cellctl.errors.calibration import (
    CalibrationInvalidated,
    MeasuredBeyondBound,
    ResultOutOfLimits,
)
from cellctl.errors.records.store import RecordNotWritten
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS, STEREO_HEAD_1, STOP_LATENCY
from cellctl.records.entries import RunResult, Verdict
from cellctl.records.procedure_entries import CALIBRATION_REJECTED
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.steps import HeldMeanwhile
from tests.unit.procedures.rig import ProcedureRig

CHECKS = [
    {"name": "rms", "value": 0.31, "limit": 0.2, "unit": "px", "side": "max", "passed": False},
    {"name": "views", "value": 24, "limit": 12, "unit": "", "side": "min", "passed": True},
]


def outcome(rig: ProcedureRig, *, passed: bool = True) -> ProcedureOutcome:
    record = dict(read_calibration(rig.bench.calibrations.path, "head_1").record)
    checks = [] if passed else CHECKS
    return ProcedureOutcome(
        STEREO_HEAD_1, record | {"checks": checks}, passed, ("few views",), b"png", "FH-0001"
    )


@pytest.fixture
def procedure(rig: ProcedureRig) -> list[object]:
    """Answers of procedure 101, one after the other."""
    answers: list[object] = []

    async def run(context: ProcedureContext) -> ProcedureOutcome | None:
        answer = answers.pop(0)
        if isinstance(answer, BaseException):
            raise answer
        assert answer is None or isinstance(answer, ProcedureOutcome)
        return answer

    rig.procedures[101] = replace(rig.procedures[101], run=run)
    return answers


def test_the_procedures_of_the_process(rig: ProcedureRig) -> None:
    assert set(rig.procedures) == {*range(101, 110), 10_801}


async def test_a_result_that_passed_is_kept(rig: ProcedureRig, procedure: list[object]) -> None:
    procedure.append(outcome(rig))
    job = rig.job(101)
    await job.start()
    assert rig.board.current.step == 101
    await job.execute()
    assert await job.close(RunResult.GOOD, None) is RunResult.GOOD
    assert rig.board.current.step == 0
    stored = read_calibration(rig.bench.calibrations.path, "head_1")
    assert stored.serial_number == "FH-0001"
    days = (stored.valid_until - stored.made).days
    assert days == rig.bench.settings.validity_days
    assert (rig.bench.calibrations.path / "head_1.png").read_bytes() == b"png"
    known = await rig.archive.do(RunStore.calibrations)
    assert [entry.id for entry in known] == [stored.id]
    (who, what, detail), (_, ended, end) = await rig.audit()
    assert (who, what, detail["item"]) == ("line", "calibration stored", "head_1")
    assert (ended, end["outcome"]) == ("procedure ended", "good")
    (head,) = await rig.archive.do(RunStore.runs)
    assert (head.mode, head.result, head.recipe_id) == ("maintenance", "good", 101)
    assert head.number == job.run_number
    record = await rig.archive.do(RunStore.run, head.number)
    assert record.document("calibration")["id"] == stored.id
    assert [artefact.name for artefact in record.artefacts] == ["cell.json", "motion.mcap"]
    assert await rig.archive.do(RunStore.verify) == []


async def test_a_bad_result_is_put_aside_with_its_reason(
    rig: ProcedureRig, procedure: list[object]
) -> None:
    before = read_calibration(rig.bench.calibrations.path, "head_1").id
    procedure.append(outcome(rig, passed=False))
    job = rig.job(101)
    with pytest.raises(ResultOutOfLimits, match=r"head_1: rms 0\.31, limit 0\.2 px; kept in"):
        await job.execute()
    assert read_calibration(rig.bench.calibrations.path, "head_1").id == before
    aside = rig.bench.calibrations.path / "rejected" / "head_1.json"
    assert json.loads(aside.read_text())["checks"] == CHECKS
    assert await job.close(RunResult.ABORTED, ResultOutOfLimits("head_1")) is RunResult.ABORTED
    (who, what, told), (_, _, ended) = await rig.audit()
    assert (who, what, told["item"], told["run"]) == ("line", CALIBRATION_REJECTED, "head_1", 0)
    assert told["reason"] == f"rms 0.31, limit 0.2 px; kept in {aside.parent}"
    assert "F614" in ended["fault"]


async def test_a_bad_result_leaves_its_figures_in_its_run(
    rig: ProcedureRig, procedure: list[object]
) -> None:
    procedure.append(outcome(rig, passed=False))
    job = rig.job(101)
    await job.start()
    with pytest.raises(ResultOutOfLimits) as refused:
        await job.execute()
    await job.close(RunResult.ABORTED, refused.value)
    record = await rig.archive.do(RunStore.run, job.run_number)
    found = {key: (one.value, one.unit, one.verdict) for key, one in record.newest_figures.items()}
    assert found == {
        "head_1.rms": (0.31, "px", Verdict.FAIL),
        "head_1.views": (24.0, "", Verdict.PASS),
    }


async def test_a_bad_result_keeps_its_verdict_when_its_figures_cannot_be_written(
    rig: ProcedureRig, procedure: list[object], monkeypatch: pytest.MonkeyPatch
) -> None:
    async def refuse(*_: object) -> None:
        raise RecordNotWritten("disk full")

    job = rig.job(101)
    await job.start()
    monkeypatch.setattr(RunRecorder, "figures", refuse)
    procedure.append(outcome(rig, passed=False))
    with pytest.raises(ResultOutOfLimits, match=r"rms 0\.31"):
        await job.execute()
    procedure.append(replace(outcome(rig), record={**outcome(rig).record, "checks": CHECKS[1:]}))
    with pytest.raises(RecordNotWritten):
        await job.execute()
    await job.close(RunResult.ABORTED, None)


async def test_a_bad_result_keeps_its_reason_when_it_cannot_be_put_aside(
    rig: ProcedureRig, procedure: list[object]
) -> None:
    (rig.bench.calibrations.path / "rejected").write_text("a file, no folder")
    procedure.append(outcome(rig, passed=False))
    with pytest.raises(ResultOutOfLimits, match=r"rms 0\.31, limit 0\.2 px; and not kept"):
        await rig.job(101).execute()


LATENCY_CHECKS = [
    {"name": "upper bound", "value": 313.7, "limit": 300.0, "unit": "ms", "passed": False},
    {"name": "sigma", "value": 4.0, "limit": 15.0, "unit": "ms", "passed": True},
]


WITHIN_BOUND = {"upper_ms": 292.0, "verdict": "pass", "checks": []}


def beyond_bound(*, noisy: bool = False) -> ProcedureOutcome:
    bound, sigma = LATENCY_CHECKS
    checks = [bound, {**sigma, "value": 20.0, "passed": False} if noisy else sigma]
    record = {"upper_ms": 313.7, "checks": checks}
    bounds = frozenset({"upper bound"})
    return ProcedureOutcome(STOP_LATENCY, record, False, (), None, "", bounds)


@pytest.mark.parametrize("made_before", [True, False])
async def test_a_bound_that_a_measurement_refutes_is_not_started_with(
    rig: ProcedureRig, procedure: list[object], made_before: bool
) -> None:
    """Neither with the bound nor with the smaller figure that was stored before."""
    calibrations = rig.bench.calibrations
    if made_before:
        calibrations.store(STOP_LATENCY, WITHIN_BOUND, "", timedelta(days=1))
    assert calibrations.fault(CALIBRATIONS, timedelta(hours=1)) is None
    procedure.append(beyond_bound())
    with pytest.raises(MeasuredBeyondBound, match=r"upper bound 313\.7, limit 300 ms"):
        await rig.job(101).execute()
    refused = calibrations.fault(CALIBRATIONS, timedelta(hours=1))
    assert isinstance(refused, CalibrationInvalidated)
    assert "F615" in refused.detail
    known = await rig.archive.do(RunStore.calibrations)
    assert [one.kind for one in known if one.invalidated] == ["stop_latency"] * made_before
    assert (await rig.audit())[-1][1] == "calibrations invalidated"


async def test_a_new_result_within_the_bound_lifts_that(
    rig: ProcedureRig, procedure: list[object]
) -> None:
    calibrations = rig.bench.calibrations
    procedure += [beyond_bound(), replace(beyond_bound(), record=WITHIN_BOUND, passed=True)]
    with pytest.raises(MeasuredBeyondBound):
        await rig.job(101).execute()
    await rig.job(101).execute()
    assert calibrations.fault(CALIBRATIONS, timedelta(hours=1)) is None


async def test_a_doubtful_measurement_refutes_no_bound(
    rig: ProcedureRig, procedure: list[object]
) -> None:
    procedure.append(beyond_bound(noisy=True))
    with pytest.raises(ResultOutOfLimits, match="sigma 20"):
        await rig.job(101).execute()
    assert rig.bench.calibrations.fault(CALIBRATIONS, timedelta(hours=1)) is None


async def test_a_procedure_that_was_held_begins_again(
    rig: ProcedureRig, procedure: list[object]
) -> None:
    procedure += [HeldMeanwhile(), HeldMeanwhile(), outcome(rig)]
    await rig.job(101).execute()
    assert procedure == []


async def test_half_of_a_pair_stores_nothing(rig: ProcedureRig, procedure: list[object]) -> None:
    procedure.append(None)
    await rig.job(101).execute()
    assert await rig.archive.do(RunStore.calibrations) == []


async def test_progress_is_told_and_a_hold_is_obeyed(rig: ProcedureRig) -> None:
    await rig.context.progress(3, 24, "view")
    assert rig.board.current.iteration == 3
    assert rig.board.current.message == "view 3 of 24"
    rig.pauses._held_at = (2,)
    with pytest.raises(HeldMeanwhile):
        await rig.context.progress(4, 24, "view")


async def test_a_procedure_that_works_on_parts_opens_its_record_itself(rig: ProcedureRig) -> None:
    async def run(context: ProcedureContext) -> ProcedureOutcome | None:
        await context.record.open(rig.bench.recipe, "teaching", ())
        return None

    rig.procedures[101] = replace(rig.procedures[101], run=run, handles_parts=True)
    job = rig.job(101)
    await job.start()
    assert job.run_number == 0
    await job.execute()
    await job.close(RunResult.GOOD, None)
    (head,) = await rig.archive.do(RunStore.runs)
    assert (head.process, head.mode) == ("deck-to-frame", "teaching")
    assert head.recipe_id == rig.bench.recipe.id
