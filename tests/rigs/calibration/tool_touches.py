"""A tool that touches a point and shows its axes, with known truth."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import pose_from_xyzabc

FLANGE_T_TOOL = pose_from_xyzabc([12, -7, 180, 30, 5, -10])
POINT_M = np.array([1.5, 0.2, 0.4])
ANGLES_DEG = [(0, 0, 180), (20, 30, 170), (-40, -25, 190), (60, 10, 150), (10, -35, 200)]


def touching(rng: np.random.Generator, count: int, sigma_m: float) -> list[RigidTransform]:
    poses = []
    for angles in ANGLES_DEG[:count]:
        turn = Rotation.from_euler("ZYX", angles, degrees=True)
        tip = POINT_M + rng.normal(0, sigma_m, 3)
        poses.append(
            RigidTransform.from_components(tip - turn.apply(FLANGE_T_TOOL.translation), turn)
        )
    return poses


def orienting(rng: np.random.Generator, sigma_m: float) -> list[RigidTransform]:
    turn = Rotation.from_euler("ZYX", [5, 10, 175], degrees=True)
    axes = turn * FLANGE_T_TOOL.rotation
    poses = []
    for step in ([0, 0, 0], [0.1, 0, 0], [0.03, 0.08, 0]):
        tip = POINT_M + axes.apply(step) + rng.normal(0, sigma_m, 3)
        poses.append(
            RigidTransform.from_components(tip - turn.apply(FLANGE_T_TOOL.translation), turn)
        )
    return poses
