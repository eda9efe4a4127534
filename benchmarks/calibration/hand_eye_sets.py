"""Sets of hand-eye poses with errors of several kinds, and closed forms to compare with.

What is stated of the noise is always the same, robot 0.05 mm and 0.005°, corners 0.1 px; what the
poses really have differs from case to case.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose
from cellctl.geometry.pose import Array
from cellctl.vision.camera.lens import project
from tests.rigs.calibration.hand_eye_views import (
    BASE_T_BOARD,
    BOARD_M,
    CAMERA,
    FLANGE_T_CAMERA,
    NOISE,
    SIGMA_PX,
    random_view,
)

Draw = Callable[[np.random.Generator, int], Array]
"""Values of unit standard deviation, of so many coordinates."""


def gaussian(rng: np.random.Generator, count: int) -> Array:
    return rng.normal(size=count)


def heavy_tailed(rng: np.random.Generator, count: int) -> Array:
    """Student's t with three degrees of freedom: one scale for all coordinates of a pose."""
    scale = np.sqrt(rng.chisquare(3.0) / 3.0)
    return np.asarray(rng.normal(size=count) / scale / np.sqrt(3.0))


@dataclass(frozen=True, slots=True)
class PoseErrors:
    """The errors that a set of poses really has."""

    position_m: float = NOISE.position_m
    rotation_rad: float = NOISE.rotation_rad
    corner_px: float = SIGMA_PX
    hanging_px: float = 0.0
    """Size of an error at the board's corners that is smooth within a view and differs by view."""
    draw: Draw = gaussian


ROBOT_FAR_WORSE = PoseErrors(3e-4, float(np.radians(0.03)))
KINDS = {
    "as stated": PoseErrors(),
    "heavy tails": PoseErrors(draw=heavy_tailed),
    "alike within a view": PoseErrors(hanging_px=0.3),
    "robot six times worse": ROBOT_FAR_WORSE,
    "robot's angles six times worse": PoseErrors(rotation_rad=float(np.radians(0.03))),
    "robot's places six times worse": PoseErrors(position_m=3e-4),
    "robot ten times better": PoseErrors(5e-6, float(np.radians(5e-4))),
    "corners five times worse": PoseErrors(corner_px=0.5),
    "robot worse, heavy tails": PoseErrors(3e-4, float(np.radians(0.03)), draw=heavy_tailed),
}


def drawn_set(kind: PoseErrors, count: int, seed: int) -> list[HandEyePose]:
    """Eye in hand: flange_T_camera is ``FLANGE_T_CAMERA``."""
    rng = np.random.default_rng([seed, count])
    flat = BOARD_M[:, :2] / np.abs(BOARD_M[:, :2]).max(axis=0)
    poses = []
    for number in range(count):
        seen = random_view(rng)
        flange = BASE_T_BOARD * seen.inv() * FLANGE_T_CAMERA.inv()
        pixels = project(CAMERA, seen.apply(BOARD_M))
        pixels = pixels + kind.corner_px * rng.normal(size=pixels.shape)
        terms = np.column_stack([np.ones(len(flat)), flat, flat**2, flat.prod(axis=1)])
        pixels = pixels + kind.hanging_px * terms @ rng.normal(size=(6, 2)) / np.sqrt(6.0)
        board, _ = board_in_camera(CAMERA, BOARD_M, pixels, SIGMA_PX)
        error = kind.draw(rng, 6)
        turn = Rotation.from_rotvec(error[3:] * kind.rotation_rad) * flange.rotation
        place = flange.translation + error[:3] * kind.position_m
        reported = RigidTransform.from_components(place, turn)
        poses.append(HandEyePose(f"pose {number}", reported, board))
    return poses


def park(poses: Sequence[HandEyePose]) -> RigidTransform:
    """Park and Martin 1994, over all pairs of poses, as OpenCV 4's ``CALIB_HAND_EYE_PARK``."""
    robot, camera = _motions(poses)
    moment = sum(
        np.outer(b.rotation.as_rotvec(), a.rotation.as_rotvec())
        for a, b in zip(robot, camera, strict=True)
    )
    # R = (MᵀM)^-1/2 Mᵀ, which is the orthogonal factor of Mᵀ.
    u, _, vt = np.linalg.svd(np.asarray(moment).T)
    rotation = Rotation.from_matrix(u @ vt)
    return RigidTransform.from_components(_translation(robot, camera, rotation), rotation)


def daniilidis(poses: Sequence[HandEyePose]) -> RigidTransform:
    """Daniilidis 1999, dual quaternions, as OpenCV 4's ``CALIB_HAND_EYE_DANIILIDIS``."""
    rows = []
    for a, b in zip(*_motions(poses), strict=True):
        real_a, dual_a = _dual_quaternion(a)
        real_b, dual_b = _dual_quaternion(b)
        top = np.column_stack([real_a - real_b, _skew(real_a + real_b), np.zeros((3, 4))])
        low = np.column_stack(
            [dual_a - dual_b, _skew(dual_a + dual_b), real_a - real_b, _skew(real_a + real_b)]
        )
        rows += [top, low]
    _, _, vt = np.linalg.svd(np.concatenate(rows))
    u1, v1, u2, v2 = vt[6, :4], vt[6, 4:], vt[7, :4], vt[7, 4:]
    candidates = []
    for ratio in np.roots([u1 @ v1, u1 @ v2 + u2 @ v1, u2 @ v2]).real:
        length = ratio**2 * u1 @ u1 + 2.0 * ratio * u1 @ u2 + u2 @ u2
        candidates.append((length, ratio))
    length, ratio = max(candidates)
    real, dual = ((ratio * one + two) / np.sqrt(length) for one, two in ((u1, u2), (v1, v2)))
    w, x = real[0], real[1:]
    translation = 2.0 * (-dual[0] * x + w * dual[1:] + np.cross(x, dual[1:]))
    return RigidTransform.from_components(translation, Rotation.from_quat([*x, w]))


def _motions(
    poses: Sequence[HandEyePose],
) -> tuple[list[RigidTransform], list[RigidTransform]]:
    """A and B of AX = XB for all pairs of poses."""
    robot, camera = [], []
    for index, one in enumerate(poses):
        for other in poses[index + 1 :]:
            robot.append(other.base_T_flange.inv() * one.base_T_flange)
            camera.append(other.camera_T_board.pose * one.camera_T_board.pose.inv())
    return robot, camera


def _translation(
    robot: Sequence[RigidTransform], camera: Sequence[RigidTransform], rotation: Rotation
) -> Array:
    matrices = np.concatenate([one.rotation.as_matrix() - np.eye(3) for one in robot])
    knowns = np.concatenate(
        [rotation.apply(b.translation) - a.translation for a, b in zip(robot, camera, strict=True)]
    )
    return np.asarray(np.linalg.lstsq(matrices, knowns, rcond=None)[0])


def _dual_quaternion(motion: RigidTransform) -> tuple[Array, Array]:
    """Vector parts of the real and the dual quaternion."""
    x, y, z, w = motion.rotation.as_quat(canonical=True)
    axis = np.array([x, y, z])
    dual = 0.5 * (w * motion.translation + np.cross(motion.translation, axis))
    return axis, dual


def _skew(vector: Array) -> Array:
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
