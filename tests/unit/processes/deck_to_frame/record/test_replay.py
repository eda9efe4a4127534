"""A recorded run is computed anew from its raw images: identical, or what differs by how much."""

import asyncio
import importlib
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.errors.vision import HoleMissing
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces import StereoPair
from cellctl.packml.state import State
from cellctl.processes.deck_to_frame.poses.part_measurer import (
    HeadGeometry,
    PartMeasurement,
    SeenPair,
    deck_in_frame,
)
from cellctl.records.files.raw_images import MEDIA_TYPE
from cellctl.records.store import RunStore
from cellctl.vision.features.feature_file import FeatureFile
from cellctl.vision.registration.part_pose import PartPose
from cellctl.vision.registration.relative_pose import RelativePose
from tests.unit.cell.bench import TruthMeasurer
from tests.unit.daemon_rig import DaemonRig

module = importlib.import_module("cellctl.processes.deck_to_frame.record.replay")


@dataclass
class Seeing:
    """Images that each stand for what is measured in them."""

    found: dict[bytes, PartPose] = field(default_factory=dict)
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))
    asked: list[RigidTransform | None] = field(default_factory=list)

    def shot(self, measured: PartMeasurement, predicted: RigidTransform) -> PartMeasurement:
        images = self.rng.integers(0, 256, (4, 6, 8), dtype=np.uint8)
        pairs = StereoPair(images[0], images[1], 0.0, 1), StereoPair(images[2], images[3], 0.0, 1)
        self.found[images[0].tobytes()] = measured.pose
        return replace(measured, predicted=predicted, shots=(pairs,))

    def measure_pair(self, left: Any, _right: Any, *_: Any, **named: Any) -> bytes:
        self.asked.append(named["camera_T_part"])
        return bytes(left.tobytes())

    def combined(
        self, _features: FeatureFile, taken: Sequence[tuple[bytes, bytes]], *_: Any
    ) -> tuple[None, PartPose]:
        return None, self.found[taken[0][0]]


def by_their_poses(frame: PartPose, deck: PartPose, heads: HeadGeometry, _: str) -> RelativePose:
    """Measure as the ``TruthMeasurer`` does, whose parts have no holes."""
    return deck_in_frame(frame, deck, heads, "paper")


@pytest.fixture
def seeing(monkeypatch: pytest.MonkeyPatch) -> Seeing:
    seeing, measure = Seeing(), TruthMeasurer.measure

    async def measured(
        self: TruthMeasurer, features: FeatureFile, c1_T_part: RigidTransform, **more: Any
    ) -> PartMeasurement:
        return seeing.shot(await measure(self, features, c1_T_part, **more), c1_T_part)

    monkeypatch.setattr(TruthMeasurer, "measure", measured)
    monkeypatch.setattr(module, "measure_pair", seeing.measure_pair)
    monkeypatch.setattr(module, "combined", seeing.combined)
    monkeypatch.setattr(module, "deck_in_frame", by_their_poses)
    return seeing


async def good_run(daemon_rig: DaemonRig) -> list[str]:
    """Names of its raw images."""
    await daemon_rig.started(serial="SAT-7")
    await daemon_rig.to(State.COMPLETED)
    artefacts = (await daemon_rig.record()).artefacts
    return [artefact.name for artefact in artefacts if artefact.media_type == MEDIA_TYPE]


async def replay(daemon_rig: DaemonRig, *options: str) -> tuple[int, str]:
    path = await daemon_rig.archive.do(lambda store: store.path)
    arguments = ["replay", "1", "--data-dir", str(path), *options]
    runner = CliRunner(env={"COLUMNS": "160", "NO_COLOR": "1"})
    result = await asyncio.to_thread(runner.invoke, whole_app(), arguments)
    return result.exit_code, result.stdout or str(result.exception)


async def test_a_recorded_run_comes_out_the_same(daemon_rig: DaemonRig, seeing: Seeing) -> None:
    names = await good_run(daemon_rig)
    assert len(names) == 4 * len(seeing.found)
    assert names[0] == "raw/frame-frame-1-head-1-left.pgm.zst"
    code, said = await replay(daemon_rig, "--every")
    assert code == 0, said
    for name in ("frame", "deck", "flange_T_deck", "iteration-1", "error X", "seated"):
        assert name in said, name
    assert "pin_offsets.P1" in said
    counted = re.search(r"(\d+) of (\d+) numbers are identical", said)
    assert counted is not None
    assert counted[1] == counted[2]


async def test_what_differs_is_named_with_its_size(daemon_rig: DaemonRig, seeing: Seeing) -> None:
    await good_run(daemon_rig)
    for key, pose in seeing.found.items():
        moved = RigidTransform.from_translation([1e-6, 0.0, 0.0]) * pose.pose.pose
        seeing.found[key] = replace(pose, pose=UncertainPose(moved, pose.pose.covariance))
    code, said = await replay(daemon_rig)
    assert code == 1
    assert "0.001" in said
    assert "frame" in said


@pytest.mark.parametrize(("found_today", "code"), [(False, 0), (True, 1)])
async def test_the_images_of_a_measurement_that_failed_are_looked_at_again(
    daemon_rig: DaemonRig,
    seeing: Seeing,
    monkeypatch: pytest.MonkeyPatch,
    found_today: bool,
    code: int,
) -> None:
    missing = HoleMissing("P2")

    async def failing(self: TruthMeasurer, *_: Any, **__: Any) -> PartMeasurement:
        images = seeing.rng.integers(0, 256, (2, 6, 8), dtype=np.uint8)
        self.seen = [SeenPair(1, 2, StereoPair(images[0], images[1], 0.0, 1))]
        raise missing

    def look(*_: Any, **__: Any) -> None:
        if not found_today:
            raise missing

    monkeypatch.setattr(TruthMeasurer, "measure", failing)
    monkeypatch.setattr(module, "measure_pair", look)
    await daemon_rig.started(serial="SAT-7")
    await daemon_rig.to(State.ABORTED)
    record = await daemon_rig.record()
    images = [one.name for one in record.artefacts if one.media_type == MEDIA_TYPE]
    assert images == [
        f"raw/failed-frame-frame-1-head-2-{side}.pgm.zst" for side in ("left", "right")
    ]
    pictures = [one.name for one in record.artefacts if one.media_type == "image/jpeg"]
    assert pictures == [f"failed-frame-head-2-{side}.jpg" for side in ("left", "right")]
    exit_code, said = await replay(daemon_rig, "--every")
    assert exit_code == code, said
    assert "failed-frame" in said
    assert "fault F421" in said


async def test_a_run_without_raw_images_says_so(daemon_rig: DaemonRig) -> None:
    await daemon_rig.started(serial="SAT-7")
    await daemon_rig.to(State.COMPLETED)
    code, said = await replay(daemon_rig)
    assert code == 1
    assert "F813" in said
    assert await daemon_rig.archive.do(RunStore.verify) == []
