"""Written poses, errors and the propagation of covariances."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import pose_error, pose_from_xyzabc, pose_to_xyzabc, turn_matrix
from cellctl.geometry.uncertain import UncertainPose, skew

mm = st.floats(-5000, 5000)
angle = st.floats(-179, 179)
tilt = st.floats(-89, 89)


@given(mm, mm, mm, angle, tilt, angle)
def test_written_form_round_trips(
    x: float, y: float, z: float, a: float, b: float, c: float
) -> None:
    written = [x, y, z, a, b, c]
    assert pose_to_xyzabc(pose_from_xyzabc(written)) == pytest.approx(written, abs=1e-6)


@given(st.tuples(*[st.floats(-4.0, 4.0)] * 3), st.sampled_from([1.0, 1e-2, 1e-3, 1e-6, 0.0]))
def test_the_matrix_of_a_turn_is_that_of_scipy(
    turn: tuple[float, float, float], size: float
) -> None:
    turn_rad = size * np.array(turn)
    expected = Rotation.from_rotvec(turn_rad).as_matrix()
    np.testing.assert_allclose(turn_matrix(turn_rad), expected, rtol=0, atol=5e-15)


def test_a_zero_is_written_without_a_sign() -> None:
    for pose in (pose_from_xyzabc([-0.0] * 6), pose_from_xyzabc([0.0] * 6).inv()):
        assert not np.signbit(pose_to_xyzabc(pose)).any()


@given(mm, mm, mm, angle, angle, angle)
def test_written_form_is_that_of_scipy(
    x: float, y: float, z: float, a: float, b: float, c: float
) -> None:
    turn = Rotation.from_euler("ZYX", [a, b, c], degrees=True)
    pose = RigidTransform.from_components([x * 1e-3, y * 1e-3, z * 1e-3], turn)
    assert pose_from_xyzabc([x, y, z, a, b, c]).as_matrix() == pytest.approx(
        pose.as_matrix(), abs=1e-12
    )
    written = pose_to_xyzabc(pose)
    assert written[:3] == pytest.approx([x, y, z], abs=1e-9)
    again = Rotation.from_euler("ZYX", written[3:], degrees=True)
    assert (again.inv() * turn).magnitude() < 1e-12
    assert abs(written[4]) <= 90.0


def test_a_turns_about_z_then_b_about_the_new_y() -> None:
    pose = pose_from_xyzabc([0, 0, 0, 90, 90, 0])
    assert pose.apply([1, 0, 0]) == pytest.approx([0, 0, -1], abs=1e-12)


@pytest.mark.parametrize("bad", [[1, 2, 3], [0, 0, 0, 0, 0, float("nan")]])
def test_a_pose_is_six_finite_numbers(bad: list[float]) -> None:
    with pytest.raises(ValueError, match="six finite numbers"):
        pose_from_xyzabc(bad)


def test_pose_error_is_in_the_parent_axes() -> None:
    expected = pose_from_xyzabc([100, 0, 0, 90, 0, 0])
    turn = RigidTransform.from_rotation(Rotation.from_rotvec([0.01, 0, 0]))
    measured = RigidTransform.from_translation([0.001, 0, 0]) * turn * expected
    shift, rotation = pose_error(expected, measured)
    assert shift == pytest.approx([0.001, 0, 0], abs=1e-9)
    assert rotation == pytest.approx([0.01, 0, 0])


def perturbed(pose: RigidTransform, delta: np.ndarray) -> RigidTransform:
    return RigidTransform.from_components(
        pose.translation + delta[..., :3], Rotation.from_rotvec(delta[..., 3:]) * pose.rotation
    )


def scatter(nominal: RigidTransform, drawn: RigidTransform) -> np.ndarray:
    return np.cov(np.hstack(pose_error(nominal, drawn)).T)


def test_covariances_of_products_and_inverses_match_the_scatter() -> None:
    rng = np.random.default_rng(7)
    first = pose_from_xyzabc([300, -200, 500, 30, 20, -60])
    second = pose_from_xyzabc([-100, 400, 900, -70, 10, 40])
    sigma = np.array([1e-5, 2e-5, 3e-5, 1e-5, 4e-5, 2e-5])
    covariance = np.diag(sigma**2)
    chain = UncertainPose(first, covariance) * UncertainPose(second, covariance)
    inverse = UncertainPose(first, covariance).inv()
    deltas = rng.normal(size=(4000, 2, 6)) * sigma
    products = perturbed(first, deltas[:, 0]) * perturbed(second, deltas[:, 1])
    inverses = perturbed(first, deltas[:, 0]).inv()
    for expected, nominal, drawn in (
        (chain.covariance, chain.pose, products),
        (inverse.covariance, inverse.pose, inverses),
    ):
        scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
        assert np.abs(scatter(nominal, drawn) - expected).max() < 0.1 * scale.max()
        assert np.diag(scatter(nominal, drawn)) / np.diag(expected) == pytest.approx(1, abs=0.12)


def test_skew_is_the_cross_product() -> None:
    a, b = np.array([1.0, -2.0, 3.0]), np.array([0.5, 4.0, -1.0])
    assert skew(a) @ b == pytest.approx(np.cross(a, b))


@pytest.mark.parametrize("middle_deg", [90.0, -90.0])
def test_at_the_poles_the_rotation_is_kept_and_nobody_is_warned(middle_deg: float) -> None:
    pose = pose_from_xyzabc([1.0, 2.0, 3.0, 40.0, middle_deg, -15.0])
    written = pose_to_xyzabc(pose)
    assert written[4] == pytest.approx(middle_deg)
    assert written[5] == pytest.approx(0.0, abs=1e-9)
    _, turned_rad = pose_error(pose, pose_from_xyzabc(written))
    assert turned_rad == pytest.approx(np.zeros(3), abs=1e-7)
