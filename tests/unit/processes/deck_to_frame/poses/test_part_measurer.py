"""Measuring a part: as many frames as it takes, and nothing moves meanwhile."""

from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import pytest

from cellctl.cell.lighting.auto_exposure import RunExposures
from cellctl.errors.link import ReplyTimeout, StaleData
from cellctl.errors.robot import HeadMoved
from cellctl.errors.vision import HoleMissing, ImageBlack
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces import StereoCamera
from cellctl.processes.deck_to_frame.faults import UncertaintyTooLarge
from cellctl.processes.deck_to_frame.poses import part_measurer as measuring
from cellctl.processes.deck_to_frame.poses.part_measurer import (
    HeadGeometry,
    PartMeasurement,
    PartMeasurer,
)
from cellctl.processes.deck_to_frame.recipe import PoseCorrection
from cellctl.vision.measurement import PairMeasurement
from cellctl.vision.registration.chi_square import ChiSquare
from cellctl.vision.registration.measured_points import MeasuredPoints
from cellctl.vision.registration.part_pose import PartPose
from tests.unit.cell.bench import Bench

PLACE = pose_from_xyzabc([10, 20, 500, 5, 1, 179])
SIGMA = np.repeat([20e-6, 50e-6], 3)
"""Standard deviations of one frame."""


@dataclass
class Eyes:
    """Vision that only counts: one frame has SIGMA, n frames less by the root of n."""

    bench: Bench
    calls: list[tuple[Any, ...]] = field(default_factory=list)
    during: Any = None
    """Called while a picture is looked at."""

    def __post_init__(self) -> None:
        self.bench.cell.workers.answers["measure_pair"] = self._look

    def _look(self, left: Any, right: Any, model: Any, holes: Any, **known: Any) -> PairMeasurement:
        self.calls.append((model, [hole.name for hole in holes], known))
        if self.during is not None:
            self.during()
        return PairMeasurement("default", ())

    @staticmethod
    def average(found: Any) -> PairMeasurement:
        return PairMeasurement("default", (), frames=len(found))

    @staticmethod
    def pose(one: PairMeasurement, two: PairMeasurement, *_: Any) -> PartPose:
        assert one.frames == two.frames
        covariance = np.diag(SIGMA**2) / one.frames
        return PartPose(
            UncertainPose(PLACE, covariance),
            covariance,
            covariance,
            (),
            np.zeros((0, 3)),
            np.zeros(6),
            (),
            ChiSquare(6.0, 6),
            MeasuredPoints.seen(one, None, None, ()),
        )


@pytest.fixture
def eyes(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> Eyes:
    monkeypatch.setattr(measuring, "average", Eyes.average)
    monkeypatch.setattr(measuring, "part_pose", Eyes.pose)
    return Eyes(bench)


@dataclass
class Exposures:
    """Notes which heads were exposed anew, and how many pictures had been measured by then."""

    eyes: Eyes | None = None
    found: list[tuple[str, int]] = field(default_factory=list)

    async def find(self, device: StereoCamera) -> None:
        self.found.append((device.name, 0 if self.eyes is None else len(self.eyes.calls)))


def measurer(bench: Bench, exposures: Exposures | None = None) -> PartMeasurer:
    geometry = bench.geometry()
    heads = HeadGeometry.of(geometry, PoseCorrection())
    found = cast(RunExposures, exposures or Exposures())
    return PartMeasurer(bench.deck, heads, "default", found)


async def measured(
    bench: Bench, *, frames: int = 2, max_frames: int = 12, wanted: float = 1.0
) -> PartMeasurement:
    """``wanted``: in parts of what one frame has."""
    return await measurer(bench).measure(
        bench.features()[0],
        PLACE,
        frames=frames,
        max_frames=max_frames,
        wanted_sigma_mm_deg=np.concatenate([SIGMA[:3] * 1e3, np.degrees(SIGMA[3:])]) * wanted,
    )


async def test_each_head_looks_for_its_own_holes_where_they_should_be(
    bench: Bench, eyes: Eyes
) -> None:
    found = await measured(bench)
    assert found.frames == 2
    geometry = bench.geometry()
    features = bench.features()[0]
    first = [call for call in eyes.calls if call[1] == list(features.head_1)]
    second = [call for call in eyes.calls if call[1] == list(features.head_2)]
    assert len(first) == len(second) == 2
    np.testing.assert_allclose(first[0][2]["camera_T_part"].as_matrix(), PLACE.as_matrix())
    np.testing.assert_allclose(
        second[0][2]["camera_T_part"].as_matrix(),
        (geometry.c1_T_c2.pose.inv() * PLACE).as_matrix(),
    )
    assert found.c1_T_part is PLACE
    np.testing.assert_allclose(found.sigma_mm_deg[:3], SIGMA[:3] * 1e3 / np.sqrt(2))


@pytest.mark.parametrize(("wanted", "frames"), [(1.0, 2), (0.6, 4), (0.4, 8), (0.29, 12)])
async def test_frames_are_added_until_it_is_certain(
    bench: Bench, eyes: Eyes, wanted: float, frames: int
) -> None:
    assert (await measured(bench, wanted=wanted)).frames == frames


async def test_more_frames_than_allowed_are_not_taken(bench: Bench, eyes: Eyes) -> None:
    with pytest.raises(UncertaintyTooLarge, match="after 12 frames"):
        await measured(bench, wanted=0.1)
    assert len(eyes.calls) == 24
    eyes.calls.clear()
    with pytest.raises(UncertaintyTooLarge, match="after 1 frames"):
        await measured(bench, frames=5, max_frames=1, wanted=0.1)


@pytest.mark.parametrize("who", ["main", "aux_1", "aux_2"])
async def test_nobody_may_move_while_pictures_are_taken(bench: Bench, eyes: Eyes, who: str) -> None:
    robot = getattr(bench.cell, who)

    def nudge() -> None:
        robot.flange = robot.flange * pose_from_xyzabc([0, 0, 0.06, 0, 0, 0])
        eyes.during = None

    eyes.during = nudge
    with pytest.raises(HeadMoved):
        await measured(bench)


async def test_a_head_that_moved_between_two_measurements_is_noticed(
    bench: Bench, eyes: Eyes
) -> None:
    shared = measurer(bench)
    wanted = np.full(6, 1.0)
    known = {"frames": 1, "max_frames": 2, "wanted_sigma_mm_deg": wanted}
    features = bench.features()[0]
    await shared.measure(features, PLACE, **known)  # type: ignore[arg-type]
    bench.cell.main.flange *= pose_from_xyzabc([0, 0, 50, 0, 0, 0])
    await shared.measure(features, PLACE, **known)  # type: ignore[arg-type]
    bench.cell.aux_2.flange *= pose_from_xyzabc([0, 0, 0, 0.006, 0, 0])
    with pytest.raises(HeadMoved, match="head_2"):
        await shared.measure(features, PLACE, **known)  # type: ignore[arg-type]


async def test_a_stale_robot_state_is_not_measured_with(bench: Bench, eyes: Eyes) -> None:
    shared = measurer(bench)
    bench.cell.main.faults["state"] = StaleData("0.4 s")
    with pytest.raises(StaleData):
        await shared.measure(
            bench.features()[0], PLACE, frames=1, max_frames=1, wanted_sigma_mm_deg=np.ones(6)
        )
    assert eyes.calls == []


async def test_what_was_seen_is_kept_when_the_measurement_fails(bench: Bench, eyes: Eyes) -> None:
    shared = measurer(bench)
    known = {"frames": 2, "max_frames": 2, "wanted_sigma_mm_deg": np.full(6, 1.0)}

    def miss_in_the_second_frame() -> None:
        if len(eyes.calls) == 4:
            raise HoleMissing("P1")

    eyes.during = miss_in_the_second_frame
    with pytest.raises(HoleMissing):
        await shared.measure(bench.features()[0], PLACE, **known)  # type: ignore[arg-type]
    seen = {(one.frame, one.head) for one in shared.seen}
    assert seen == {(1, 1), (1, 2), (2, 1), (2, 2)}
    eyes.during = None
    await shared.measure(bench.features()[0], PLACE, **known)  # type: ignore[arg-type]
    assert shared.seen == [], "the measurement itself has them then"


async def test_exposures_are_found_before_the_first_picture(bench: Bench, eyes: Eyes) -> None:
    exposures = Exposures(eyes)
    known = {"frames": 1, "max_frames": 1, "wanted_sigma_mm_deg": np.full(6, 1.0)}
    await measurer(bench, exposures).measure(bench.features()[0], PLACE, **known)  # type: ignore[arg-type]
    assert sorted(exposures.found) == [("head_1", 0), ("head_2", 0)]
    assert len(eyes.calls) == 2


async def test_faults_of_camera_and_vision_come_through(bench: Bench, eyes: Eyes) -> None:
    bench.cell.head_1.camera.silent = True  # type: ignore[attr-defined]
    with pytest.raises(ReplyTimeout):
        await measured(bench)

    def miss() -> None:
        raise HoleMissing("P1")

    eyes.during = miss
    with pytest.raises(HoleMissing):
        await measured(bench)


async def test_an_image_that_cannot_be_measured_names_its_head(bench: Bench, eyes: Eyes) -> None:
    def dark() -> None:
        if len(eyes.calls) == 2:
            raise ImageBlack("left: brightest grey value is 4")

    eyes.during = dark
    with pytest.raises(ImageBlack) as raised:
        await measured(bench)
    assert raised.value.detail == "head_2, left: brightest grey value is 4"
