import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cellctl.errors.vision import CalibrationFileInvalid
from cellctl.vision.camera.stereo_head import (
    StereoHead,
    read_stereo_head,
    stereo_head_from_json,
    stereo_head_to_json,
)
from tests.unit.vision.plates import table_1_head, write_stereo_head


def test_a_head_survives_its_file(tmp_path: Path) -> None:
    head = table_1_head()
    rng = np.random.default_rng(1)
    root = rng.normal(size=(24, 24))
    head = StereoHead(
        head.image_size,
        head.left,
        head.right,
        head.rotation,
        head.translation_m,
        0.19,
        root @ root.T * 1e-6,
    )
    path = tmp_path / "head.json"
    write_stereo_head(path, head, {"views": [{"rms_px": 0.1}]})
    again = read_stereo_head(path)
    assert again.image_size == (2448, 2048)
    assert np.array_equal(again.left.camera_matrix, head.left.camera_matrix)
    assert np.array_equal(again.right.distortion, head.right.distortion)
    assert np.allclose(again.translation_m, head.translation_m, rtol=1e-14)
    assert again.covariance is not None
    assert head.covariance is not None
    assert np.allclose(again.covariance, head.covariance, rtol=1e-12)
    data = json.loads(path.read_text())
    assert data["views"] == [{"rms_px": 0.1}]
    assert np.linalg.norm(data["translation_mm"]) == pytest.approx(179.0, abs=1e-9)


STORED = Path(__file__).parents[4] / "config" / "demo-calibration" / "head_1.json"


def test_a_head_is_read_as_a_cell_stores_it() -> None:
    record = json.loads(STORED.read_text())["record"]
    assert list(read_stereo_head(STORED).image_size) == record["image_size"]


def test_a_stored_head_that_was_changed_is_refused(tmp_path: Path) -> None:
    content = json.loads(STORED.read_text())
    content["record"]["left"]["camera_matrix"][0][0] += 1.0
    path = tmp_path / "head_1.json"
    path.write_text(json.dumps(content))
    with pytest.raises(CalibrationFileInvalid, match="it was changed"):
        read_stereo_head(path)


def test_the_pose_between_the_cameras_is_that_of_the_file() -> None:
    head = table_1_head()
    point = np.array([0.01, -0.02, 0.5])
    expected = head.rotation @ point + head.translation_m
    assert np.allclose(head.right_T_left.apply(point), expected, atol=1e-15)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1.1]]}, "rotation"),
        ({"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}, "reflection"),
        ({"translation_mm": [0, 0, 0]}, "baseline"),
        ({"image_size": [0, 5]}, "image_size"),
        ({"left": {"distortion": [0, 0, 0, 0, 0]}}, "camera_matrix"),
        ({"left": {"camera_matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}}, "distortion"),
        ({"translation_mm": [1, "x", 0]}, "x"),
    ],
)
def test_what_is_wrong_with_a_file_is_named(
    tmp_path: Path, change: dict[str, Any], word: str
) -> None:
    path = tmp_path / "head.json"
    write_stereo_head(path, table_1_head())
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    with pytest.raises(CalibrationFileInvalid, match=word):
        read_stereo_head(path)


def test_files_that_are_no_files(tmp_path: Path) -> None:
    with pytest.raises(CalibrationFileInvalid, match="No such file"):
        read_stereo_head(tmp_path / "none.json")
    (tmp_path / "text.json").write_text("hello")
    with pytest.raises(CalibrationFileInvalid, match="not JSON"):
        read_stereo_head(tmp_path / "text.json")


def test_a_calibration_that_did_not_pass_is_read_with_a_warning(tmp_path: Path) -> None:
    path = tmp_path / "head.json"
    write_stereo_head(path, table_1_head(), {"verdict": "fail"})
    with pytest.warns(UserWarning, match="did not pass its checks"):
        read_stereo_head(path)


@pytest.mark.parametrize("terms", [4, 6, 15])
def test_lengths_that_no_lens_has_are_refused(terms: int) -> None:
    data = stereo_head_to_json(table_1_head())
    data["left"]["distortion"] = [0.0] * terms
    with pytest.raises(ValueError, match="left: distortion must hold finite numbers"):
        stereo_head_from_json(data)
