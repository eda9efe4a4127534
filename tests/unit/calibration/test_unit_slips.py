"""Input files in metres and radians, on the shipped samples."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cellctl.calibration.input_file import InputFile, read_input
from cellctl.calibration.solvers.base_frame.base_frame_input import BaseFrameFile
from cellctl.calibration.solvers.hand_eye.hand_eye_input import HandEyeFile
from cellctl.calibration.solvers.tool.tool_input import ToolFile
from cellctl.calibration.solvers.transfer.transfer_input import TransferFile
from cellctl.errors.config import FileInvalid

SAMPLES = Path(__file__).parents[3] / "config" / "samples"
MODELS: dict[str, type[InputFile]] = {
    "base-frame.json": BaseFrameFile,
    "hand-eye.json": HandEyeFile,
    "transfer.json": TransferFile,
    "tool.json": ToolFile,
}


def changed(content: Any, key: str, change: Callable[[float], float], inside: bool = False) -> Any:
    """The content with every number below a key changed."""
    if isinstance(content, dict):
        return {
            name: changed(value, key, change, inside or name == key)
            for name, value in content.items()
        }
    if isinstance(content, list):
        return [changed(value, key, change, inside) for value in content]
    return change(content) if inside and isinstance(content, float | int) else content


@pytest.mark.parametrize("name", MODELS)
def test_a_sample_is_taken(name: str) -> None:
    read_input(SAMPLES / name, MODELS[name])


@pytest.mark.parametrize(
    ("name", "key", "factor", "said"),
    [
        ("base-frame.json", "position_mm", 1e-3, "position_mm: millimetres"),
        ("base-frame.json", "joints_deg", 0.0174533, "joints_deg: degrees"),
        ("transfer.json", "position_mm", 1e-3, "position_mm: millimetres"),
        ("base-frame.json", "d1_mm", 1e-3, "d1_mm"),
    ],
)
def test_another_unit_is_refused(
    tmp_path: Path, name: str, key: str, factor: float, said: str
) -> None:
    content = json.loads((SAMPLES / name).read_text())
    path = tmp_path / name
    path.write_text(json.dumps(changed(content, key, lambda number: number * factor)))
    with pytest.raises(FileInvalid, match=said):
        read_input(path, MODELS[name])


@pytest.mark.parametrize("axis", ["a1", "a2"])
def test_the_stops_of_one_axis_alone_in_radians_are_refused(tmp_path: Path, axis: str) -> None:
    """Copied from two programs: the axis would be found kilometres away."""
    content = json.loads((SAMPLES / "base-frame.json").read_text())
    content[axis] = changed(content[axis], "joints_deg", lambda number: number * 0.0174533)
    path = tmp_path / "base-frame.json"
    path.write_text(json.dumps(content))
    with pytest.raises(FileInvalid, match=f"{axis}, joints_deg: degrees belong here"):
        read_input(path, BaseFrameFile)


def test_flange_poses_in_metres_are_refused(tmp_path: Path) -> None:
    content = json.loads((SAMPLES / "tool.json").read_text())
    for pose in content["touching"]:
        for row in pose[:3] if len(pose) == 4 else ():
            row[3] *= 1e-3
        if len(pose) == 6:
            pose[:3] = [length * 1e-3 for length in pose[:3]]
    path = tmp_path / "tool.json"
    path.write_text(json.dumps(content))
    with pytest.raises(FileInvalid, match="touching: millimetres belong here"):
        read_input(path, ToolFile)


@pytest.mark.parametrize("keys", [("base_T_flange", "camera_T_board"), ("camera_T_board",)])
def test_poses_of_robot_and_camera_in_metres_are_refused(
    tmp_path: Path, keys: tuple[str, ...]
) -> None:
    """Both in metres fit each other, and the result is a thousand times too small."""
    content = json.loads((SAMPLES / "hand-eye.json").read_text())
    for entry in content["poses"]:
        for key in keys:
            entry[key][:3] = [length * 1e-3 for length in entry[key][:3]]
    path = tmp_path / "hand-eye.json"
    path.write_text(json.dumps(content))
    with pytest.raises(FileInvalid, match=f"{keys[0]}: millimetres belong here"):
        read_input(path, HandEyeFile)
