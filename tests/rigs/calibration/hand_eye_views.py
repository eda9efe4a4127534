"""A camera on a flange that looks at a board, with known truth."""

from functools import cache

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.calibration.solvers.hand_eye.hand_eye_result import (
    HandEyePose,
    RobotNoise,
    Setup,
)
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import CameraModel

CAMERA = CameraModel(
    np.array([[3580.0, 0, 1224], [0, 3580, 995], [0, 0, 1]]),
    np.array([-0.07, 0.17, 4e-4, -3e-4, 0.0]),
)
BOARD_M = np.array([[x, y, 0.0] for y in range(8) for x in range(11)]) * 0.015 - [0.075, 0.052, 0]
FLANGE_T_CAMERA = pose_from_xyzabc([60, -20, 90, 10, 5, -3])
BASE_T_BOARD = pose_from_xyzabc([1500, 100, 200, 20, 0, 0])
BASE_T_CAMERA, FLANGE_T_BOARD = BASE_T_BOARD, FLANGE_T_CAMERA
"""The same places in the other setup: the camera stands, and the flange carries the board."""
NOISE = RobotNoise(5e-5, float(np.radians(0.005)))
SIGMA_PX = 0.1


def small(rng: np.random.Generator, position_m: float, rotation_rad: float) -> RigidTransform:
    turn = Rotation.from_rotvec(rng.normal(0, rotation_rad, 3))
    return RigidTransform.from_components(rng.normal(0, position_m, 3), turn)


def random_view(rng: np.random.Generator) -> RigidTransform:
    """Board about 500 mm ahead, z towards the camera, tilted up to 30°."""
    tilt = Rotation.from_euler("xyz", rng.uniform(-30, 30, 3), degrees=True)
    facing = Rotation.from_euler("x", 180, degrees=True)
    shift = [*rng.uniform(-0.05, 0.05, 2), rng.uniform(0.45, 0.55)]
    return RigidTransform.from_components(np.array(shift), tilt * facing)


def disturbed(rng: np.random.Generator, base_T_flange: RigidTransform) -> RigidTransform:
    """What the robot reports: errors of position and angle in the axes of its base."""
    error = small(rng, NOISE.position_m, NOISE.rotation_rad)
    return RigidTransform.from_components(
        base_T_flange.translation + error.translation, error.rotation * base_T_flange.rotation
    )


def make_poses(seed: int, setup: Setup, count: int = 20) -> list[HandEyePose]:
    """X = FLANGE_T_CAMERA and Z = BASE_T_BOARD, or X = BASE_T_CAMERA and Z = FLANGE_T_BOARD."""
    return list(_poses(seed, setup, count))


@cache
def _poses(seed: int, setup: Setup, count: int) -> tuple[HandEyePose, ...]:
    rng = np.random.default_rng(seed)
    poses = []
    for number in range(count):
        seen = random_view(rng)
        if setup is Setup.EYE_IN_HAND:
            base_T_flange = BASE_T_BOARD * seen.inv() * FLANGE_T_CAMERA.inv()
        else:
            base_T_flange = BASE_T_CAMERA * seen * FLANGE_T_BOARD.inv()
        pixels = project(CAMERA, seen.apply(BOARD_M)) + rng.normal(0, SIGMA_PX, (88, 2))
        measured, _ = board_in_camera(CAMERA, BOARD_M, pixels, SIGMA_PX)
        poses.append(HandEyePose(f"pose {number}", disturbed(rng, base_T_flange), measured))
    return tuple(poses)
