"""Pose files for the calibrations that take no images, and still poses of a loaded force sensor."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.boards.board_pose import BoardPoint
from cellctl.calibration.pose_record import covariance_to_written
from cellctl.calibration.solvers.base_frame.axis_fit import AxisStop
from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.geometry.pose import MM, Array, pose_to_xyzabc
from tests.rigs.calibration import board_placements as transfer_case
from tests.rigs.calibration import hand_eye_views as hand_eye_case
from tests.rigs.calibration import tool_touches as tool_case
from tests.rigs.calibration import turned_arm as base_frame_case
from tests.rigs.payload_world import format_pose_file, imperfect, record


def write_hand_eye(path: Path) -> None:
    """Twelve poses of a camera on the flange before a fixed board."""
    poses = hand_eye_case.make_poses(1, Setup.EYE_IN_HAND, 12)
    entries = [
        {
            "name": pose.name,
            "base_T_flange": _pose(pose.base_T_flange),
            "camera_T_board": _pose(pose.camera_T_board.pose),
            "covariance_mm_deg": covariance_to_written(pose.camera_T_board.covariance).tolist(),
        }
        for pose in poses
    ]
    write_json(path, {"setup": "eye-in-hand", "poses": entries})


def write_base_frame(path: Path) -> None:
    """Targets on the flange of an arm that turns A1 alone, then A2 alone."""
    rng = np.random.default_rng(1)
    first, second = (base_frame_case.sweep(rng, joint, 100.0) for joint in (0, 1))
    content = {"d1_mm": 1045, "a1_mm": 500, "a1": _stops(first), "a2": _stops(second)}
    write_json(path, content)


def write_transfer(path: Path) -> None:
    """The target board before each head, seen by the head and by the large-field head."""
    rng = np.random.default_rng(1)
    case = transfer_case
    content: dict[str, Any] = {"c_T_base": _pose(case.C_T_BASE)}
    for key, base_T_head, seen in (
        ("head_1", case.BASE_T_C1, case.C1_T_BOARD),
        ("head_2", case.BASE_T_C2, case.C2_T_BOARD),
    ):
        large_m, head_m = np.full(3, case.LARGE_SIGMA_M), np.full(3, 2e-6)
        large = case.board_points(rng, case.C_T_BASE * base_T_head * seen, large_m)
        near = case.board_points(rng, seen, head_m)
        content[key] = [{"large_field": _points(large, large_m), "head": _points(near, head_m)}]
    write_json(path, content)


def write_tool(path: Path) -> None:
    """A tip on one point from five sides, and led along the axes of the tool."""
    rng = np.random.default_rng(1)
    content = {
        "touching": [_pose(pose) for pose in tool_case.touching(rng, 5, 5e-5)],
        "orienting": [_pose(pose) for pose in tool_case.orienting(rng, 5e-5)],
    }
    write_json(path, content)


def write_payload(path: Path) -> None:
    """Wrenches of a still load of 200 kg in the orientations of the procedure."""
    rng = np.random.default_rng(31)
    path.write_text(format_pose_file(record(imperfect(rng), rng)), encoding="utf-8")


def write_json(path: Path, content: Any) -> None:
    """Numbers to a tenth of a micrometre and better: no digit that nobody measured."""
    path.write_text(json.dumps(_rounded(content), indent=1) + "\n", encoding="utf-8")


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        # Covariances are tiny in these units; their leading digits count.
        return round(value, 5) if abs(value) > 0.01 else float(f"{value:.5g}")
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    return [_rounded(one) for one in value] if isinstance(value, list) else value


def _pose(pose: RigidTransform) -> list[float]:
    numbers: list[float] = pose_to_xyzabc(pose).tolist()
    return numbers


def _stops(axis: Iterable[AxisStop]) -> list[dict[str, Any]]:
    return [
        {
            "joints_deg": np.degrees(stop.joints_rad).tolist(),
            "targets": [
                {
                    "name": target.name,
                    "position_mm": (target.position_m / MM).tolist(),
                    "sigma_mm": target.sigma_m / MM,
                }
                for target in stop.targets
            ],
        }
        for stop in axis
    ]


def _points(points: Iterable[BoardPoint], sigma_m: Array) -> list[dict[str, Any]]:
    return [
        {
            "name": point.name,
            "position_mm": (point.position_m / MM).tolist(),
            "sigma_mm": float(sigma_m[0]) / MM,
        }
        for point in points
    ]
