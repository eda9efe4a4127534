"""What the report shows of a measurement that failed."""

from types import SimpleNamespace
from typing import Any, cast

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry
from cellctl.processes.deck_to_frame.record.failed_picture import draw_failed, expected_rims
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead
from cellctl.vision.features.feature_file import FeatureFile
from cellctl.vision.features.hole import Hole

SIZE = (320, 240)
FOCAL_PX, BASELINE_M, AWAY_M = 400.0, 0.1, 0.5


@pytest.fixture
def heads() -> HeadGeometry:
    matrix = np.array([[FOCAL_PX, 0.0, 160.0], [0.0, FOCAL_PX, 120.0], [0.0, 0.0, 1.0]])
    camera = CameraModel(matrix, np.zeros(5))
    head = StereoHead(SIZE, camera, camera, np.eye(3), np.array([-BASELINE_M, 0.0, 0.0]), 0.1)
    same = UncertainPose(RigidTransform.identity(), np.zeros((6, 6)))
    return HeadGeometry(head, head, same)


def part(*holes: Hole) -> FeatureFile:
    """A part of which head I sees these holes, and head II none."""
    seen = {1: holes, 2: ()}
    return cast(FeatureFile, SimpleNamespace(seen_by=lambda head: seen[head]))


def hole(x_m: float) -> Hole:
    return Hole("P1", "plain", 0.02, np.array([x_m, 0.0, 0.0]))


def middles(expected: Any) -> dict[tuple[int, str], Array]:
    return {view: rims[0].outline_px.mean(axis=0) for view, rims in expected.items() if rims}


def test_each_camera_is_told_where_the_rim_should_be(heads: HeadGeometry) -> None:
    c1_T_part = RigidTransform.from_translation([0.0, 0.0, AWAY_M])
    found = expected_rims(part(hole(0.05)), c1_T_part, heads)
    at = middles(found)
    assert set(at) == {(1, "left"), (1, "right")}
    assert at[1, "left"] == pytest.approx([200.0, 120.0])
    assert at[1, "right"] == pytest.approx([120.0, 120.0])
    radii = np.linalg.norm(found[1, "left"][0].outline_px - at[1, "left"], axis=1)
    assert radii == pytest.approx(8.0)


def test_a_hole_behind_the_camera_is_expected_nowhere(heads: HeadGeometry) -> None:
    behind = RigidTransform.from_translation([0.0, 0.0, -AWAY_M])
    assert middles(expected_rims(part(hole(0.0)), behind, heads)) == {}


def test_the_picture_shows_the_image_with_the_expected_rim_and_the_fault(
    heads: HeadGeometry,
) -> None:
    c1_T_part = RigidTransform.from_translation([0.0, 0.0, AWAY_M])
    rims = expected_rims(part(hole(0.05)), c1_T_part, heads)[1, "left"]
    image = np.full(SIZE[::-1], 90, np.uint8)
    data = draw_failed(image, rims, None, "left", 421)
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape == (SIZE[1] + 48, SIZE[0], 3)
    assert picture[20, 20].astype(int) == pytest.approx([90, 90, 90], abs=6)
    # Magenta has much red and blue, and less green than the grey around it.
    blue, green, red = picture[120, 208].astype(int)
    assert min(blue, red) > green + 40
    assert picture[SIZE[1] :].max() > 200
