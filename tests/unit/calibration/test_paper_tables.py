"""Tables 1 and 2 of the paper as consistency cases.

Printed numbers carry two decimals (rotations) and some slips, named where they matter. The tests
use the geometry to tell slips from meaning.
"""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.solvers.transfer.board_transfer import head_2_in_head_1
from cellctl.geometry.pose import MM
from cellctl.geometry.uncertain import UncertainPose, skew
from cellctl.vision.camera.lens import distort
from cellctl.vision.camera.stereo_head import CameraModel

Array = NDArray[np.float64]


def camera(fx: float, fy: float, cx: float, cy: float) -> Array:
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])


# Head: K left, K right, E, F, R (two decimals, 1.00 printed as 0.99), t in mm.
HEADS = {
    "I": (
        camera(3580.35, 3578.42, 1223.88, 995.14),
        camera(3581.49, 3580.91, 1229.47, 993.17),
        np.array([[-0.07, -31.68, 0.23], [-30.96, -0.52, 176.13], [-0.067, -176.00, -0.59]]),
        np.array(
            [[8.38e-10, 3.76e-7, -3.84e-4], [3.67e-7, 6.13e-4, -7.93e-3], [-3.63e-4, 7.00e-3, 1]]
        ),
        np.array([[0.94, 0.00, 0.34], [0.00, 0.99, 0.00], [-0.34, 0.00, 0.94]]),
        np.array([-176.00, 0.33, 31.68]),
    ),
    "II": (
        camera(3569.83, 3569.70, 1219.93, 1019.48),
        camera(3569.09, 3569.19, 1221.95, 987.84),
        np.array([[0.12, -30.66, -0.08], [-29.47, -0.28, 176.62], [0.64, -176.42, -0.17]]),
        np.array(
            [
                [-2.02e-9, 5.17e-7, -5.20e-4],
                [4.97e-7, 4.77e-9, -1.13e-2],
                [-5.28e-4, 9.99e-3, 1],
            ]
        ),
        np.array([[0.94, 0.00, 0.33], [0.00, 1.00, 0.00], [-0.33, 0.00, 0.94]]),
        np.array([-176.42, -0.05, 30.66]),
    ),
}


def rotation_from(essential: Array, translation: Array) -> Rotation:
    """The rotation R that comes nearest to [t]× R = E."""
    # Columns of R off t come from E, the part along t from their cross products (Horn 1990).
    cofactors = np.cross(essential[[1, 2, 0]], essential[[2, 0, 1]])
    matrix = (cofactors - skew(translation) @ essential) / (translation @ translation)
    u, _, vt = np.linalg.svd(matrix)
    return Rotation.from_matrix(u @ vt)


@pytest.mark.parametrize("head", ["I", "II"])
def test_essential_matrix_is_cross_of_translation_and_rotation(head: str) -> None:
    _, _, essential, _, rotation, translation = HEADS[head]
    # Elementwise, within what two decimals of R allow (0.99 for 0.9999 needs 0.01).
    allowed = 0.01 * np.abs(skew(translation)).sum(axis=1, keepdims=True) + 0.01
    assert np.all(np.abs(skew(translation) @ rotation - essential) < allowed)
    # And sharply: one exact rotation explains E to its printed digits and R to its own.
    exact = rotation_from(essential, translation).as_matrix()
    assert np.abs(skew(translation) @ exact - essential).max() < 0.05
    assert np.abs(exact - rotation).max() < 0.0101
    toe_in_deg = np.degrees(Rotation.from_matrix(exact).magnitude())
    assert toe_in_deg == pytest.approx(20, abs=1)


@pytest.mark.parametrize("head", ["I", "II"])
def test_fundamental_matrix_from_camera_matrices(head: str) -> None:
    left, right, essential, printed, _, _ = HEADS[head]
    fundamental = np.linalg.inv(right).T @ essential @ np.linalg.inv(left)
    fundamental /= fundamental[2, 2]
    # E is printed with two decimals, and its small entries enter F[2, 2], which scales all of F:
    # compare the shape of F, entry by entry, in units in which all entries count.
    units = np.diag([3580.0, 3580.0, 1.0])
    ours, theirs = units @ fundamental @ units, units @ printed @ units
    compared = np.ones((3, 3), dtype=bool)
    if head == "I":
        compared[1, 1] = False  # printed 6.13e-4; the exponent is a slip, see below
    ours, theirs = ours[compared], theirs[compared]
    cosine = ours @ theirs / np.linalg.norm(ours) / np.linalg.norm(theirs)
    assert cosine > 0.998


def test_the_slip_in_the_fundamental_matrix_of_head_1() -> None:
    left, right, essential, printed, _, _ = HEADS["I"]
    fundamental = np.linalg.inv(right).T @ essential @ np.linalg.inv(left)
    fundamental /= fundamental[2, 2]
    ratio = abs(fundamental[1, 1]) / printed[1, 1]
    assert 1e-6 < ratio < 1e-4, "5 orders of magnitude off: an exponent was misread"


def test_distortion_is_printed_in_the_order_of_the_library() -> None:
    """The labels read k1, k2, k3, p1, p2, but the values are k1, k2, p1, p2, k3."""
    matrix = HEADS["I"][0]
    corner = np.array([[(2447 - 1223.88) / 3580.35, (2047 - 995.14) / 3578.42]])
    straight = corner[0] * [3580.35, 3578.42] + [1223.88, 995.14]

    def shift_px(*distortion: float) -> float:
        pixels = distort(CameraModel(matrix, np.array(distortion)), corner)
        return float(np.linalg.norm(pixels[0] - straight))

    assert shift_px(-0.068, 0.166, 0.0014, 0.0026, -0.24) < 30
    assert shift_px(-0.068, 0.166, 0.0026, -0.24, 0.0014) > 200


BASE_T_C1 = np.array(
    [[0.30, -0.94, -0.18, 2310.82], [-0.94, -0.33, 0.12, 1732.98], [-0.17, 0.13, -0.98, 1738.29]]
)
BASE_T_C2 = np.array(
    [[0.19, -0.97, -0.17, 2095.04], [-0.97, -0.21, 0.14, 306.38], [-0.17, 0.14, -0.98, 1713.23]]
)
C1_T_C2 = np.array(
    [[0.99, -0.12, -0.02, 1276.00], [0.12, 0.99, -0.02, 664.42], [0.02, 0.01, 0.99, -112.90]]
)


def pose(printed: Array) -> UncertainPose:
    u, _, vt = np.linalg.svd(printed[:, :3])
    rotation = Rotation.from_matrix(u @ vt)
    return UncertainPose.exact(RigidTransform.from_components(printed[:, 3] * MM, rotation))


def test_distance_of_the_heads_is_the_same_in_table_2() -> None:
    from_base = np.linalg.norm(BASE_T_C2[:, 3] - BASE_T_C1[:, 3])
    assert from_base == pytest.approx(np.linalg.norm(C1_T_C2[:, 3]), abs=0.01)


def test_equation_3_as_table_2_confirms_it() -> None:
    """C1_T_C2 = (B_T_C1)^-1 · B_T_C2; the printed equation would give the inverse direction.

    Two decimals of a rotation are 0.3°, which is up to 10 mm at the distance of the heads.
    """
    c1_T_c2 = head_2_in_head_1(pose(BASE_T_C1), pose(BASE_T_C2)).pose
    assert np.abs(c1_T_c2.translation / MM - C1_T_C2[:, 3]).max() < 15
    assert (c1_T_c2.rotation * pose(C1_T_C2).pose.rotation.inv()).magnitude() < np.radians(1)
    as_printed = c1_T_c2.inv()
    assert np.linalg.norm(as_printed.translation / MM - C1_T_C2[:, 3]) > 1000
