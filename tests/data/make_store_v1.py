# mypy: ignore-errors
# ruff: noqa: I001 - imports of modules that no longer exist cannot be sorted
"""Makes ``store-v1``: a store of schema 1, written by the steps of the assembly themselves.

It needs the code that wrote such stores, commit 5ad746d, and cannot run with any later one, which
is why neither the tests nor mypy look at it. In a checkout of that commit:

    PYTHONPATH=. .venv/bin/python tests/data/make_store_v1.py tests/data/store-v1

Vision and contact are stood in for as in the unit tests; everything else is the real journal. The
folder also gets ``expected/``: ``run.json`` and the words of the report as that code exported them.
"""

import asyncio
import dataclasses
import json
import shutil
import sqlite3
import sys
import tempfile
from datetime import UTC, datetime, timedelta
from html.parser import HTMLParser
from pathlib import Path

import cv2
import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.processes.deck_to_frame.faults import MatingOverforce
from cellctl.errors.link import LinkLost
from cellctl.processes.deck_to_frame.faults import SeatedOffPosition
from cellctl.force.commissioning import StiffnessEstimate
from cellctl.force.compliance import Sideways
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.journal import Journal
from cellctl.processes.deck_to_frame.mating.result import (
    GivingWay,
    MatingPhase,
    MatingProgress,
    Reading,
)
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry
from cellctl.processes.deck_to_frame.steps import mate_deck as mating_step
from cellctl.processes.deck_to_frame.steps.correct_pose import compensate
from cellctl.processes.deck_to_frame.steps.mate_deck import mate_deck
from cellctl.processes.deck_to_frame.steps.measure_deck import measure_deck
from cellctl.processes.deck_to_frame.steps.measure_frame import measure_frame
from cellctl.processes.deck_to_frame.steps.pre_assembly import pre_assembly
from cellctl.processes.deck_to_frame.steps.verify import verify
from cellctl.records.async_store import Archive
from cellctl.records.entries import RunResult
from cellctl.records.files.curve_file import MEDIA_TYPE, encode_curve
from cellctl.records.report import export_run
from cellctl.records.store import RunStore
from cellctl.runtime.progress import ProgressBoard
from cellctl.version import software
from cellctl.vision.measurement import HoleMeasurement, PairMeasurement
from tests.unit.cell.bench import Bench, TruthMeasurer, make_bench
from tests.unit.processes.deck_to_frame.rig import Pauses, RunRig, seated
from tests.unit.records.sample import force_curve

RNG = np.random.default_rng(1)
OFF_SEAT_MM = 0.3


class NoisyMeasurer(TruthMeasurer):
    """The true world with a little noise, and the holes that a head would have seen."""

    async def measure(self, features, c1_T_part, **wanted):
        found = await super().measure(features, c1_T_part, **wanted)
        pose = found.pose.pose
        shaken = pose.pose * pose_from_xyzabc(RNG.normal(0, [3e-3] * 3 + [3e-4] * 3))
        fitted = dataclasses.replace(
            found.pose,
            pose=dataclasses.replace(pose, pose=shaken),
            residuals_m=RNG.normal(0, 3e-6, found.pose.residuals_m.shape),
            outliers=(found.pose.names[-1],) if len(self.measured) == 1 else (),
        )
        half = len(features.holes) // 2
        heads = tuple(
            PairMeasurement("default", tuple(_hole(hole, shaken) for hole in seen))
            for seen in (features.holes[:half], features.holes[half:])
        )
        return dataclasses.replace(found, pose=fitted, heads=heads)


def _hole(hole, c1_T_part):
    position_m = c1_T_part.apply(hole.position_m)
    pixel = np.array([1224.0, 1024.0]) + 3500.0 * position_m[:2] / position_m[2]
    return HoleMeasurement(
        name=hole.name, kind=hole.kind, left_px=pixel, right_px=pixel - [1240.0, 0.3],
        left_covariance_px2=np.eye(2), right_covariance_px2=np.eye(2), position_m=position_m,
        covariance_m2=np.diag([2e-6, 2e-6, 6e-6]) ** 2, left_ellipse=None, right_ellipse=None,
        diameter_m=6.003e-3, epipolar_px=0.1,
    )  # fmt: skip


class Contact:
    """Stands in for the mating: ends on the seat, off it, or with a fault."""

    def __init__(self, offset_mm: float = 0.0, fault: Exception | None = None) -> None:
        self.offset_mm, self.fault = offset_mm, fault

    async def __call__(self, robot, guard, measured_plan, report, max_tries):
        plan = await measured_plan(1)
        felt = force_curve(peak_n=36.0, seconds=1.2)
        report(MatingProgress(MatingPhase.ENDED, 0.01, 36.0, curve=felt))
        if self.fault is not None:
            raise self.fault
        off = pose_from_xyzabc([self.offset_mm, 0, 0, 0, 0, 0])
        robot.flange = plan.pose_at(plan.window.expected_m) * off
        result = seated(plan)
        reading = Reading(0.8, 0.0095, np.array([4.0, -1.0, 9.0, 0.1, 0.2, 0.0]), np.full(6, 0.3))
        yielded = Sideways(3e-5, -1e-5, 1e-5)
        return dataclasses.replace(
            result,
            gave_way=(GivingWay(reading, yielded, yielded),),
            stiffness=StiffnessEstimate(812.4e3, 9.1e3, 0.0098, 0.4),
            relaxing=(dataclasses.replace(reading, wrench=np.array([0.1, 0, 20, 0, 0, 0])),),
        )


def _picture(*_: object) -> bytes:
    pixels = RNG.integers(60, 90, (24, 32), dtype=np.uint8)
    cv2.circle(pixels, (16, 12), 6, 20, -1)
    return bytes(cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, 60])[1])


def _start(store: RunStore, serial: str, mode: str, calibration_ids: dict[str, str]) -> int:
    return store.start_run(
        serial=serial, recipe_id=1, recipe_name="panel 500 x 1000", recipe_hash="ab" * 32,
        mode=mode, software=software(), config_hash="cd" * 32,
        calibration_ids=calibration_ids, simulated=True, operator="ORDER-7",
    )  # fmt: skip


def _new_part(rig: RunRig, number: int) -> RunRig:
    rig.journal = type(rig.journal)(rig.archive, rig.journal.workers, number)
    rig.bench.cell.main.flange = RigidTransform.from_translation([1.5, 0.0, 1.8])
    rig.truth.measured.clear()
    return rig


async def _assemble(rig: RunRig, contact: Contact) -> None:
    """All steps of one run; raises what ends it."""
    mating_step.mate_until_seated = contact
    run = rig.run()
    await measure_frame(run)
    await measure_deck(run)
    await pre_assembly(run)
    # The deck slips a little in its gripper, so that the loop has something to correct.
    rig.bench.world.flange_T_deck *= pose_from_xyzabc([0.6, -0.4, 0.2, 0.05, 0.02, -0.03])
    await compensate(run)
    await mate_deck(run)
    await verify(run)


async def _fill(rig: RunRig) -> None:
    store: RunStore = rig.archive._store
    stored = rig.bench.calibrations.stored()
    for calibration in stored:
        await rig.archive.do(RunStore.add_calibration, calibration)
    ids = {calibration.kind: calibration.id for calibration in stored}

    async def open_run(serial: str, mode: str = "production") -> int:
        return await rig.archive.do(lambda _: _start(store, serial, mode, ids))

    async def close(run: int, result: RunResult, fault=None) -> None:
        facts = {"fault_number": fault.number, "fault": str(fault)} if fault else {}
        await rig.archive.do(lambda _: store.close_run(run, result, **facts))

    good = await open_run("SAT-0001")
    await _assemble(_new_part(rig, good), Contact())
    await close(good, RunResult.GOOD)

    bad = await open_run("SAT-0002")
    try:
        await _assemble(_new_part(rig, bad), Contact(OFF_SEAT_MM))
    except SeatedOffPosition as fault:
        await close(bad, RunResult.BAD, fault)

    aborted = await open_run("SAT-0003")
    try:
        await _assemble(_new_part(rig, aborted), Contact(fault=MatingOverforce("46.1 N")))
    except MatingOverforce as fault:
        reason = fault
    await rig.archive.do(lambda _: store.add_alarm(aborted, reason.number, str(reason)))
    await rig.archive.do(lambda _: store.acknowledge_alarms(reason.number, "terminal:anna"))
    cut = encode_curve(force_curve(seconds=1.2), datetime.now(UTC), {"attempt": "2"})
    cut = cut[: len(cut) * 2 // 3]
    await rig.archive.do(lambda _: store.add_artefact(aborted, "force-2.mcap", cut, MEDIA_TYPE))
    await close(aborted, RunResult.ABORTED, reason)

    crashed = await open_run("SAT-0004", "dry run")
    run = _new_part(rig, crashed).run()
    await measure_frame(run)
    await measure_deck(run)
    await rig.archive.do(lambda _: store.mark_interrupted())

    left_open = await open_run("SAT-0005")
    await measure_frame(_new_part(rig, left_open).run())

    lost = LinkLost("aux_1: no answer")
    await rig.archive.do(lambda _: store.add_alarm(None, lost.number, str(lost)))
    for hole, mm in (("P1", 5.95), ("P5", 5.97), ("P1", 5.93)):
        await rig.archive.do(lambda _, h=hole, d=mm: store.set_gauge(good, h, d, "OP-7"))
        detail = {"run": good, "hole": hole, "diameter_mm": mm}
        await rig.archive.do(lambda _, d=detail: store.audit("OP-7", "gauge", d))
    await rig.archive.do(lambda _: store.invalidate_calibration(stored[-1], "collision"))
    await rig.archive.do(lambda _: store.note_line_seq(41))


class EmptyRig(RunRig):
    """The rig of the unit tests, without the run that it opens by itself."""

    def __init__(self, bench: Bench, store: Path) -> None:
        self.bench, self.number, self.pauses = bench, 0, Pauses()
        self.archive, self.board = Archive(store), ProgressBoard()
        bench.cell.workers.answers["draw"] = _picture
        self.journal = Journal(self.archive, bench.cell.workers, 0)
        self.calibrations = bench.calibrations.read(timedelta(0))
        geometry = self.calibrations.geometry
        heads = HeadGeometry(*geometry.heads, geometry.c1_T_c2)
        self.truth = NoisyMeasurer(bench, heads, geometry.base_T_c1.pose)


class Words(HTMLParser):
    """What a reader of the report sees as text, figures left out."""

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []
        self._hidden = 0

    def handle_starttag(self, tag, attrs):
        self._hidden += tag in ("svg", "style")

    def handle_endtag(self, tag):
        self._hidden -= tag in ("svg", "style")

    def handle_data(self, data):
        if data.strip() and not self._hidden:
            self.words.append(" ".join(data.split()))


def _expect(folder: Path) -> None:
    """What this code makes of the store it has just written."""
    store = RunStore(folder, create=False)
    assert store.verify() == []
    for head in store.runs():
        with tempfile.TemporaryDirectory() as scratch:
            report = export_run(store, head.number, Path(scratch))
            words = Words()
            words.feed(report.read_text(encoding="utf-8"))
            expected = folder / "expected" / f"run-{head.number}"
            expected.mkdir(parents=True)
            shutil.copy(Path(scratch) / "run.json", expected)
            lines = json.dumps(words.words, indent=0, ensure_ascii=False)
            (expected / "report-words.json").write_text(lines + "\n", encoding="utf-8")
    store.close()


def main(folder: Path) -> None:
    """Make the store anew."""
    shutil.rmtree(folder, ignore_errors=True)
    with tempfile.TemporaryDirectory() as scratch:
        bench = make_bench(Path(scratch))
        made = Path(scratch) / "store"
        rig = EmptyRig(bench, made)
        asyncio.run(_fill(rig))
        rig.archive.close()
        shutil.copytree(made, folder, ignore=shutil.ignore_patterns("owner.lock"))
    _expect(folder)
    # One file without a journal beside it, as a daemon leaves it that ended properly.
    with sqlite3.connect(folder / "store.sqlite") as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    connection.close()
    (folder / "owner.lock").unlink(missing_ok=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
