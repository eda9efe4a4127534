"""Input files of the offline calibrations: JSON in mm and degrees (docs/calibration.md).

A pose is a 4 x 4 matrix in mm or six numbers X, Y, Z, A, B, C. Everything wrong in a file ends as
``FileInvalid`` with the place.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.calibration.boards.board_pose import BoardPoint, fit_board, target_board_discs
from cellctl.calibration.pose_record import covariance_from_written, matrix_mm_to_pose
from cellctl.calibration.solvers.base_frame.axis_fit import AxisStop
from cellctl.calibration.solvers.base_frame.base_frame import ArmGeometry
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose, RobotNoise, Setup
from cellctl.calibration.solvers.transfer.board_transfer import BoardPlacement
from cellctl.errors.calibration import CalibrationError
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.target_tracker import Target
from cellctl.vision.camera.stereo_head import CameraModel

T = TypeVar("T")
_CAMERA_SIGMA_MM, _CAMERA_SIGMA_DEG = 0.02, 0.005


@dataclass(frozen=True, slots=True)
class HandEyeInput:
    """Content of a hand-eye file."""

    setup: Setup | None
    poses: tuple[HandEyePose, ...]
    noise: RobotNoise


@dataclass(frozen=True, slots=True)
class BaseFrameInput:
    """Content of a base-frame file."""

    arm: ArmGeometry
    a1: tuple[AxisStop, ...]
    a2: tuple[AxisStop, ...]


@dataclass(frozen=True, slots=True)
class TransferInput:
    """Content of a board-transfer file."""

    c_T_base: UncertainPose
    before_head_1: tuple[BoardPlacement, ...]
    before_head_2: tuple[BoardPlacement, ...]


@dataclass(frozen=True, slots=True)
class ToolInput:
    """Content of a tool file."""

    touching: tuple[RigidTransform, ...]
    orienting: tuple[RigidTransform, ...]
    touch_sigma_m: float


def read_hand_eye(path: Path) -> HandEyeInput:
    """Read a hand-eye file."""
    return _read(path, _hand_eye)


def read_base_frame(path: Path) -> BaseFrameInput:
    """Read a base-frame file."""
    return _read(path, _base_frame)


def read_transfer(path: Path) -> TransferInput:
    """Read a board-transfer file."""
    return _read(path, _transfer)


def read_tool(path: Path) -> ToolInput:
    """Read a tool file."""
    return _read(path, _tool)


def _read(path: Path, convert: Callable[[Mapping[str, Any]], T]) -> T:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileInvalid(f"{path}: {error.strerror or error}") from error
    except ValueError as error:
        raise FileInvalid(f"{path} is not JSON: {error}") from error
    if not isinstance(data, dict):
        raise FileInvalid(f"{path}: the file must hold one object")
    try:
        return convert(data)
    except CalibrationError:
        raise
    except KeyError as error:
        raise FileInvalid(f"{path}: missing {error}") from error
    except (TypeError, ValueError, AttributeError) as error:
        raise FileInvalid(f"{path}: {error}") from error


def _each(data: Mapping[str, Any], key: str, convert: Callable[[Any], T]) -> tuple[T, ...]:
    """Convert a list and say which entry is wrong."""
    entries = data[key]
    if not isinstance(entries, list):
        raise TypeError(f"{key} must be a list")
    values = []
    for number, entry in enumerate(entries, start=1):
        try:
            values.append(convert(entry))
        except KeyError as error:
            raise ValueError(f"{key}, entry {number}: missing {error}") from error
        except (TypeError, ValueError) as error:
            raise ValueError(f"{key}, entry {number}: {error}") from error
    return tuple(values)


def _hand_eye(data: Mapping[str, Any]) -> HandEyeInput:
    numbers = iter(range(1, len(data["poses"]) + 1))
    noise = RobotNoise(
        float(data.get("robot_sigma_mm", 0.05)) * MM,
        float(np.radians(data.get("robot_sigma_deg", 0.005))),
    )
    setup = Setup(data["setup"]) if "setup" in data else None

    def pose(entry: Mapping[str, Any]) -> HandEyePose:
        name = str(entry.get("name", f"pose {next(numbers)}"))
        return HandEyePose(name, matrix_mm_to_pose(entry["base_T_flange"]), _board(data, entry))

    return HandEyeInput(setup, _each(data, "poses", pose), noise)


def _board(data: Mapping[str, Any], entry: Mapping[str, Any]) -> UncertainPose:
    """camera_T_board as given, or from corners."""
    if "corners_px" in entry:
        points_m = _points(entry.get("board_points_mm", data.get("board_points_mm"))) * MM
        matrix = np.asarray(data["camera"]["camera_matrix"], dtype=float)
        distortion = np.asarray(data["camera"].get("distortion", np.zeros(5)), dtype=float)
        pixels = np.asarray(entry["corners_px"], dtype=float)
        sigma_px = data.get("camera_sigma_px")
        camera = CameraModel(matrix, distortion)
        return board_in_camera(camera, points_m, pixels, sigma_px)[0]
    pose = matrix_mm_to_pose(entry["camera_T_board"])
    if "covariance_mm_deg" in entry:
        written = np.asarray(entry["covariance_mm_deg"], dtype=float)
        if written.shape != (6, 6):
            raise ValueError("covariance_mm_deg must be 6 x 6")
    else:
        sigma_mm = float(data.get("camera_sigma_mm", _CAMERA_SIGMA_MM))
        sigma_deg = float(data.get("camera_sigma_deg", _CAMERA_SIGMA_DEG))
        written = np.diag([sigma_mm**2] * 3 + [sigma_deg**2] * 3)
    return UncertainPose(pose, covariance_from_written(written))


def _points(values: Any) -> Array:
    points = np.asarray(values, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise ValueError("board_points_mm must be a list of points [x, y, z]")
    return points


def _base_frame(data: Mapping[str, Any]) -> BaseFrameInput:
    arm = ArmGeometry(
        d1_m=float(data["d1_mm"]) * MM,
        a1_m=float(data["a1_mm"]) * MM,
        a1_sign=int(data.get("a1_sign", 1)),
        a2_sign=int(data.get("a2_sign", 1)),
        a1_zero_rad=float(np.radians(data.get("a1_zero_deg", 0.0))),
    )
    return BaseFrameInput(arm, _each(data, "a1", _stop), _each(data, "a2", _stop))


def _stop(entry: Mapping[str, Any]) -> AxisStop:
    joints_deg = np.asarray(entry["joints_deg"], dtype=float)
    if joints_deg.shape != (6,):
        raise ValueError("joints_deg must be six numbers")
    return AxisStop(np.radians(joints_deg), _each(entry, "targets", _target))


def _target(entry: Mapping[str, Any]) -> Target:
    sigma_m = float(entry.get("sigma_mm", 0.05)) * MM
    return Target(str(entry["name"]), _position(entry), sigma_m)


def _position(entry: Mapping[str, Any]) -> Array:
    position = np.asarray(entry["position_mm"], dtype=float)
    if position.shape != (3,) or not np.isfinite(position).all():
        raise ValueError("position_mm must be three numbers")
    return position * MM


def _transfer(data: Mapping[str, Any]) -> TransferInput:
    discs = target_board_discs()
    if "drawing_mm" in data:
        discs = {
            str(name): np.asarray(place, dtype=float) * MM
            for name, place in data["drawing_mm"].items()
        }

    def placement(entry: Mapping[str, Any]) -> BoardPlacement:
        large, small = (_each(entry, key, _disc) for key in ("large_field", "head"))
        return BoardPlacement(fit_board(discs, large), fit_board(discs, small))

    base = data["c_T_base"]
    covariance = np.asarray(data.get("c_T_base_covariance_mm_deg", np.zeros((6, 6))), dtype=float)
    if isinstance(base, Mapping):  # as written by the base-frame calibration
        covariance = np.asarray(base["covariance_mm_deg"], dtype=float)
        base = base["matrix_mm"]
    return TransferInput(
        UncertainPose(matrix_mm_to_pose(base), covariance_from_written(covariance)),
        _each(data, "head_1", placement),
        _each(data, "head_2", placement),
    )


def _disc(entry: Mapping[str, Any]) -> BoardPoint:
    if "covariance_mm2" in entry:
        covariance = np.asarray(entry["covariance_mm2"], dtype=float) * MM**2
    else:
        covariance = np.eye(3) * (float(entry["sigma_mm"]) * MM) ** 2
    return BoardPoint(str(entry["name"]), _position(entry), covariance)


def _tool(data: Mapping[str, Any]) -> ToolInput:
    touching = _each(data, "touching", matrix_mm_to_pose)
    orienting: Sequence[RigidTransform] = ()
    if data.get("orienting"):
        orienting = _each(data, "orienting", matrix_mm_to_pose)
    return ToolInput(touching, tuple(orienting), float(data.get("touch_sigma_mm", 0.1)) * MM)
