"""The file of a single camera: of a command, and as a cell stores it."""

import json
from pathlib import Path

import pytest

from cellctl.errors.vision import CameraFileInvalid
from cellctl.vision.camera.single_camera import read_single_camera, single_camera_to_json

STORED = Path(__file__).parents[4] / "config" / "antenna-calibration" / "camera_2.json"


def test_a_camera_is_the_same_from_either_file(tmp_path: Path) -> None:
    stored = read_single_camera(STORED)
    path = tmp_path / "camera.json"
    path.write_text(json.dumps(single_camera_to_json(stored)))
    assert read_single_camera(path).id == stored.id


def test_a_stored_camera_that_was_changed_is_refused(tmp_path: Path) -> None:
    content = json.loads(STORED.read_text())
    content["valid_until"] = "2099-01-01T00:00:00+00:00"
    path = tmp_path / "camera_2.json"
    path.write_text(json.dumps(content))
    with pytest.raises(CameraFileInvalid, match="it was changed"):
        read_single_camera(path)
