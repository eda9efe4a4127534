"""A process that the store has never heard of records its run."""

import math
from collections.abc import AsyncIterator
from pathlib import Path

import numpy as np
import pytest

from cellctl.errors.records.store import RunClosed
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import (
    LoopPass,
    PassComponent,
    PoseOrigin,
    RunRecord,
    RunResult,
    Verdict,
)
from cellctl.records.figures import Limit, figure
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from tests.unit.records.conftest import start

PLACE = pose_from_xyzabc([10.0, 20.0, 500.0, 5.0, 1.0, 179.0])


@pytest.fixture
async def recorder(tmp_path: Path) -> AsyncIterator[RunRecorder]:
    store = AsyncRunStore(tmp_path)
    yield RunRecorder(store, await store.do(start))
    store.close()


async def record_of(recorder: RunRecorder) -> RunRecord:
    return await recorder.store.do(RunStore.run, recorder.run)


async def test_a_pin_is_found_and_inserted(recorder: RunRecorder) -> None:
    await recorder.phase(10, "find the hole")
    await recorder.measurement(
        "hole", "base", "hole", UncertainPose(PLACE, np.eye(6) * 1e-10), residual_um=4.0, frames=3
    )
    await recorder.phase(20, "insert")
    await recorder.pose("above", PoseOrigin.COMMANDED, "base", "flange", PLACE)
    judged = await recorder.figure("depth", 11.98, "mm", limit=Limit(11.9, 12.1))
    await recorder.figures([figure("peak_force", 31.0, "N"), figure("turns", 2, "")])
    await recorder.loop_pass(
        LoopPass("spiral", 1, (PassComponent("r", "mm", 0.4, None, 0.5),), converged=True)
    )
    await recorder.document("search", {"pattern": "spiral"})
    sha256 = await recorder.artefact("contact.txt", b"felt", "text/plain")
    record = await record_of(recorder)
    find, insert = record.phases
    assert [(phase.number, phase.label) for phase in record.phases] == [
        (10, "find the hole"), (20, "insert"),
    ]  # fmt: skip
    measured, commanded = record.poses
    assert (measured.key, measured.parent, measured.child, measured.phase) == (
        "hole", "base", "hole", find.id,
    )  # fmt: skip
    assert (commanded.origin, commanded.phase) == (PoseOrigin.COMMANDED, insert.id)
    assert commanded.covariance_mm_deg is None
    assert judged.verdict is Verdict.PASS
    assert [entry.key for entry in record.figures] == ["depth", "peak_force", "turns"]
    assert {entry.phase for entry in record.figures} == {insert.id}
    assert record.passes[0].worst_ratio == pytest.approx(0.8)
    assert record.document("search") == {"pattern": "spiral"}
    assert record.artefacts[0].sha256 == sha256


async def test_a_covariance_is_kept_whole_in_mm_and_degrees(recorder: RunRecorder) -> None:
    root = np.random.default_rng(1).normal(size=(6, 6)) * 1e-5
    pose = UncertainPose(PLACE, root @ root.T)
    await recorder.measurement("part", "c1", "part", pose)
    entry = (await record_of(recorder)).measurements[0]
    scale = np.array([1e3] * 3 + [180 / np.pi] * 3)
    covariance = np.array(entry.covariance_mm_deg)
    np.testing.assert_allclose(covariance, pose.covariance * np.outer(scale, scale))
    np.testing.assert_allclose(np.array(entry.sigma_mm_deg), pose.sigma * scale)
    np.testing.assert_allclose(np.array(entry.pose_mm_deg), [10, 20, 500, 5, 1, 179])


async def test_exposures_of_raw_images_by_their_files(recorder: RunRecorder) -> None:
    await recorder.exposures({"raw/none.pgm.zst": None})
    assert (await record_of(recorder)).documents == ()
    one = ExposureRecord("GL-1", "Mono12", 12, exposure_s=0.004, gain_db=3.0, device_time_ns=7)
    await recorder.exposures({"raw/a.pgm.zst": one, "raw/none.pgm.zst": None})
    await recorder.exposures({"raw/b.pgm.zst": ExposureRecord(None, "Mono8", 8)})
    kept = (await record_of(recorder)).document("images.exposures")
    assert set(kept) == {"raw/a.pgm.zst", "raw/b.pgm.zst"}
    assert ExposureRecord(**kept["raw/a.pgm.zst"]) == one


async def test_a_closed_run_takes_nothing_more(recorder: RunRecorder) -> None:
    await recorder.store.do(RunStore.close_run, recorder.run, RunResult.GOOD)
    with pytest.raises(RunClosed):
        await recorder.figure("depth", 1.0, "mm")
    with pytest.raises(RunClosed):
        await recorder.phase(10, "again")


def test_an_error_that_is_unknown_is_no_share_of_its_limit() -> None:
    known = PassComponent("x", "mm", -0.4, None, 0.5)
    free = PassComponent("z", "mm", 7.0, None, None)
    unknown = PassComponent("y", "mm", None, None, 0.5)
    assert LoopPass("loop", 1, (known, free), converged=True).worst_ratio == pytest.approx(0.8)
    assert math.isnan(LoopPass("loop", 1, (known, unknown), converged=False).worst_ratio)
