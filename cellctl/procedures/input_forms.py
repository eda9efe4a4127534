"""Readings of procedures as plain data with all digits, from which their runs are replayed."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.arm_reference import ArmReference
from cellctl.calibration.boards.board_pose import BoardPose
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces import Target


def targets_to_input(targets: Iterable[Target]) -> list[dict[str, Any]]:
    """Targets as they were measured, m."""
    return [
        {"name": one.name, "position_m": one.position_m.tolist(), "sigma_m": one.sigma_m}
        for one in targets
    ]


def targets_from_input(written: Iterable[Mapping[str, Any]]) -> tuple[Target, ...]:
    """The inverse of ``targets_to_input``."""
    return tuple(
        Target(one["name"], np.array(one["position_m"], dtype=float), one["sigma_m"])
        for one in written
    )


def look_to_input(look: ArmReference) -> dict[str, Any]:
    """The arm at one place of its joints."""
    return {"joints_rad": look.joints_rad.tolist(), "targets": targets_to_input(look.targets)}


def look_from_input(written: Mapping[str, Any]) -> ArmReference:
    """The inverse of ``look_to_input``."""
    joints_rad = np.array(written["joints_rad"], dtype=float)
    return ArmReference(joints_rad, targets_from_input(written["targets"]))


def pose_to_input(pose: UncertainPose) -> dict[str, Any]:
    """Matrix and covariance in m and rad: angles would round them."""
    return {
        "matrix": pose.pose.as_matrix().tolist(),
        "covariance": np.asarray(pose.covariance).tolist(),
    }


def pose_from_input(written: Mapping[str, Any]) -> UncertainPose:
    """The inverse of ``pose_to_input``."""
    pose = RigidTransform.from_matrix(np.array(written["matrix"], float))
    return UncertainPose(pose, np.array(written["covariance"], float))


def board_to_input(board: BoardPose) -> dict[str, Any]:
    """A board in the frame of a head."""
    return {
        "pose": pose_to_input(board.head_T_board),
        "residuals_m": dict(board.residuals_m),
        "outliers": list(board.outliers),
        "chi2_ratio": board.chi2_ratio,
    }


def board_from_input(written: Mapping[str, Any]) -> BoardPose:
    """The inverse of ``board_to_input``."""
    return BoardPose(
        pose_from_input(written["pose"]),
        dict(written["residuals_m"]),
        tuple(written["outliers"]),
        written["chi2_ratio"],
    )
