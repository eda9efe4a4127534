"""Whatever is wrong in an input file is named with its place."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cellctl.calibration.input_file import InputFile, InputPose, InputPosition, read_input
from cellctl.calibration.solvers.transfer.transfer_input import TransferFile
from cellctl.errors.config import FileInvalid

POSE = [100, 200, 300, 0, 0, 0]


class Point(InputFile):
    name: str
    position_mm: InputPosition


class Stop(InputFile):
    points: tuple[Point, ...]


class File(InputFile):
    pose: InputPose
    stops: tuple[Stop, ...] = ()
    sigma_mm: float = 0.1


def read(tmp_path: Path, data: Any) -> File:
    path = tmp_path / "in.json"
    path.write_text(json.dumps(data))
    return read_input(path, File)


def test_lengths_become_metres_and_names_may_be_numbers(tmp_path: Path) -> None:
    point = {"name": 7, "position_mm": [1, 2, 3], "comment": "ignored"}
    found = read(tmp_path, {"pose": POSE, "stops": [{"points": [point]}]})
    np.testing.assert_allclose(found.pose.translation, [0.1, 0.2, 0.3])
    np.testing.assert_allclose(found.stops[0].points[0].position_mm, [1e-3, 2e-3, 3e-3])
    assert found.stops[0].points[0].name == "7"


@pytest.mark.parametrize(
    ("stops", "reason"),
    [
        ([{"points": [{"name": "F1"}]}], "stops, entry 1: points, entry 1: missing 'position_mm'"),
        ([{"points": []}, 3], "stops, entry 2: "),
        ([{"points": [{"name": "F1", "position_mm": [1, "x", 3]}]}], "must be three numbers"),
        ([{"points": [{"name": "F1", "position_mm": [1, 2]}]}], "(key 'position_mm')"),
        ("none", "valid array, got 'none' (key 'stops')"),
    ],
)
def test_places_are_named(tmp_path: Path, stops: Any, reason: str) -> None:
    with pytest.raises(FileInvalid) as error:
        read(tmp_path, {"pose": POSE, "stops": stops})
    assert reason in str(error.value)


def test_everything_that_is_wrong_is_named_at_once(tmp_path: Path) -> None:
    with pytest.raises(FileInvalid) as error:
        read(tmp_path, {"pose": {"x": 1}, "sigma_mm": "wide"})
    assert "a pose is a 4 x 4 matrix" in str(error.value)
    assert "got 'wide' (key 'sigma_mm')" in str(error.value)


def test_a_long_list_of_errors_is_cut(tmp_path: Path) -> None:
    with pytest.raises(FileInvalid, match="; and 4 more"):
        read(tmp_path, {"pose": POSE, "stops": [0] * 9})


def test_a_number_must_be_finite(tmp_path: Path) -> None:
    with pytest.raises(FileInvalid, match="finite"):
        read(tmp_path, {"pose": POSE, "sigma_mm": float("nan")})


def test_the_base_frame_of_a_result_serves_a_transfer(tmp_path: Path) -> None:
    base = {"matrix_mm": np.eye(4).tolist(), "covariance_mm_deg": np.eye(6).tolist(), "more": 1}
    path = tmp_path / "in.json"
    path.write_text(json.dumps({"c_T_base": base, "head_1": [], "head_2": []}))
    found = read_input(path, TransferFile).base()
    assert found.sigma[0] == pytest.approx(1e-3)
    path.write_text(json.dumps({"c_T_base": {"matrix_mm": POSE}, "head_1": [], "head_2": []}))
    with pytest.raises(FileInvalid, match="c_T_base: missing 'covariance_mm_deg'"):
        read_input(path, TransferFile)
