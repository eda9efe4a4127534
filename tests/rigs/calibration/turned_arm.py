"""An arm that turns one axis at a time before the large-field head, with known truth."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.solvers.base_frame.axis_fit import ArmNoise, AxisStop
from cellctl.calibration.solvers.base_frame.base_frame import (
    ArmGeometry,
    BaseFrameResult,
    calibrate_base_frame,
)
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.interfaces.target_tracker import Target

Array = NDArray[np.float64]
ARM = ArmGeometry(d1_m=1.045, a1_m=0.5)
C_T_BASE = pose_from_xyzabc([1300, 30, 6000, 10, 1, 179]).inv()
RING = np.stack([0.2 * np.array([np.cos(a), np.sin(a), 0]) for a in np.arange(6) * np.pi / 3])
POSTURE_DEG = (10.0, -60.0, 100.0, 0.0, -40.0, 0.0)
SIGMA_M = 5e-5
NOISE = ArmNoise(repeatability_m=1.7e-5, angle_rad=1e-5)


def turn(axis: Sequence[float], angle: float) -> RigidTransform:
    return RigidTransform.from_rotation(Rotation.from_rotvec(np.array(axis) * angle))


def shift(*translation: float) -> RigidTransform:
    return RigidTransform.from_translation(translation)


def flange(joints: Array, arm: ArmGeometry = ARM) -> RigidTransform:
    """base_T_flange, written out here independently of the package."""
    q = joints
    first = turn([0, 0, 1], arm.a1_sign * q[0] + arm.a1_zero_rad) * shift(arm.a1_m, 0, arm.d1_m)
    second = turn([0, 1, 0], arm.a2_sign * q[1]) * shift(1.3, 0, 0)
    elbow = turn([0, 1, 0], q[2]) * shift(1.025, 0, 0.055)
    wrist = turn([1, 0, 0], q[3]) * turn([0, 1, 0], q[4]) * turn([1, 0, 0], q[5])
    return first * second * elbow * wrist * shift(0.29, 0, 0) * turn([0, 1, 0], np.pi / 2)


def sweep(
    rng: np.random.Generator,
    joint: int,
    arc_deg: float,
    *,
    count: int = 15,
    targets: int = 6,
    arm: ArmGeometry = ARM,
) -> list[AxisStop]:
    stops = []
    for offset in np.linspace(-arc_deg / 2, arc_deg / 2, count):
        joints = np.radians(POSTURE_DEG)
        joints[joint] += np.radians(offset)
        moved = joints.copy()
        moved[joint] += rng.normal(0, NOISE.angle_rad)
        pose = C_T_BASE * flange(moved, arm) * shift(*rng.normal(0, NOISE.repeatability_m, 3))
        seen = tuple(
            Target(f"F{i + 1}", pose.apply(RING[i]) + rng.normal(0, SIGMA_M, 3), SIGMA_M)
            for i in range(targets)
        )
        stops.append(AxisStop(joints, seen))
    return stops


def calibrate(seed: int, arc_deg: float = 100, *, targets: int = 6) -> BaseFrameResult:
    rng = np.random.default_rng(seed)
    first, second = (sweep(rng, joint, arc_deg, targets=targets) for joint in (0, 1))
    return calibrate_base_frame(first, second, ARM, noise=NOISE)
