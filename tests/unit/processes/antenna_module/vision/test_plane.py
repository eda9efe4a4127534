"""Rays to the plane and back, and the plane's file."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.errors.vision import CameraFileInvalid
from cellctl.processes.antenna_module.faults.connector import ForeignIntrinsics, PlaneFileInvalid
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane, read_plane
from cellctl.vision.camera.single_camera import (
    SingleCamera,
    read_single_camera,
    single_camera_from_json,
    single_camera_to_json,
)
from cellctl.vision.camera.stereo_head import CameraModel

MODEL = CameraModel(
    np.array([[9000.0, 0.0, 960.0], [0.0, 9010.0, 600.0], [0.0, 0.0, 1.0]]),
    np.array([-0.1, 0.05, 2e-4, -1e-4, 0.0]),
)
CAMERA = SingleCamera((1920, 1200), MODEL)
TILTED = RigidTransform.from_components(
    [0.01, -0.02, 0.25], Rotation.from_euler("xyz", [175.0, 8.0, 20.0], degrees=True)
)
FILE = {"camera_id": CAMERA.id, "camera_T_plane": [0.0, 0.0, 250.0, 0.0, 0.0, 0.0]}


def written(folder: Path, **changes: Any) -> Path:
    path = folder / "plane.json"
    path.write_text(json.dumps(FILE | changes))
    return path


def test_pixels_of_points_of_a_tilted_plane_lead_back_to_them() -> None:
    plane = MeasuringPlane(MODEL, TILTED)
    points = np.random.default_rng(1).uniform(-0.01, 0.01, (50, 2))
    assert plane.from_px(plane.to_px(points)) == pytest.approx(points, abs=1e-11)


def test_a_nearer_plane_shows_the_same_point_farther_from_the_axis() -> None:
    facing = RigidTransform.from_components([0.0, 0.0, 0.25], Rotation.from_euler("x", np.pi))
    plane = MeasuringPlane(MODEL, facing)
    point = np.array([[2e-3, 0.0]])
    seen = plane.at_height(0.01).to_px(point) - plane.to_px(point)
    # The same offset from the axis at 240 instead of 250 mm.
    assert seen[0, 0] == pytest.approx(9000.0 * 2e-3 * (1 / 0.24 - 1 / 0.25), rel=1e-2)


def test_a_plane_of_a_board_is_turned_towards_the_camera(tmp_path: Path) -> None:
    plane = read_plane(written(tmp_path))
    assert plane.camera_T_plane.rotation.as_matrix()[2, 2] == pytest.approx(-1.0)
    assert plane.sigma_height_m == pytest.approx(0.2e-3)
    assert plane.expected is None


WRONG = {
    "no identity": ({"camera_id": "cam2"}, "camera_id"),
    "behind": ({"camera_T_plane": [0, 0, -250, 0, 0, 0]}, "behind the camera"),
    "edge-on": ({"camera_T_plane": [0, 0, 250, 0, 80, 0]}, "almost edge-on"),
    "not a pose": ({"camera_T_plane": [1, 2, 3]}, "camera_T_plane"),
    "negative": ({"sigma_height_mm": -1}, "sigma_height_mm"),
}


@pytest.mark.parametrize(("change", "words"), WRONG.values(), ids=WRONG.keys())
def test_every_mistake_of_a_plane_file_is_named(
    tmp_path: Path, change: dict[str, Any], words: str
) -> None:
    with pytest.raises(PlaneFileInvalid, match=words):
        read_plane(written(tmp_path, **change))


def test_other_intrinsics_are_refused(tmp_path: Path) -> None:
    matrix = MODEL.camera_matrix + np.array([[0.0, 0.0, 1.0], [0.0] * 3, [0.0] * 3])
    other = SingleCamera(CAMERA.image_size, CameraModel(matrix, MODEL.distortion))
    plane = read_plane(written(tmp_path))
    assert plane.before(CAMERA).camera is MODEL
    with pytest.raises(ForeignIntrinsics, match=other.id[:12]):
        plane.before(other)


def test_a_camera_survives_its_file() -> None:
    again = single_camera_from_json(json.loads(json.dumps(single_camera_to_json(CAMERA))))
    assert again.id == CAMERA.id
    assert np.array_equal(again.model.camera_matrix, MODEL.camera_matrix)


VALUES = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3)


@given(
    key=st.sampled_from(["image_size", "camera_matrix", "distortion", "id"]),
    value=VALUES | st.lists(VALUES, max_size=3),
)
def test_any_value_in_a_camera_file_is_refused(
    key: str, value: Any, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "fuzzed-camera.json"
    path.write_text(json.dumps(single_camera_to_json(CAMERA) | {key: value}))
    with pytest.raises(CameraFileInvalid, match=r"fuzzed-camera\.json"):
        read_single_camera(path)
