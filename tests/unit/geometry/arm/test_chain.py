import numpy as np

from cellctl.geometry.arm.chain import flange_jacobian
from cellctl.geometry.pose import pose_error
from tests.unit.planning.deck_cell import deck_scene

CHAIN = deck_scene().arms["main"].chain


def test_the_jacobian_is_the_slope_of_the_pose() -> None:
    joints_rad = np.radians([10.0, -60.0, 100.0, 20.0, 40.0, 80.0])
    slope = flange_jacobian(CHAIN.link_frames(joints_rad))
    small_rad = 1e-6
    for joint in range(6):
        turned = joints_rad + small_rad * np.eye(6)[joint]
        way_m, turn_rad = pose_error(CHAIN.base_T_flange(joints_rad), CHAIN.base_T_flange(turned))
        measured = np.concatenate([way_m, turn_rad]) / small_rad
        np.testing.assert_allclose(slope[:, joint], measured, atol=1e-5)


def test_no_flange_is_farther_away_than_the_chain_is_long() -> None:
    for joints_rad in np.random.default_rng(1).uniform(-3.0, 3.0, (50, 6)):
        assert np.linalg.norm(CHAIN.base_T_flange(joints_rad).translation) < CHAIN.length_m


def test_the_place_of_the_flange_is_that_of_its_pose() -> None:
    joints_rad = np.radians([10.0, -60.0, 100.0, 20.0, 40.0, 80.0])
    pose = CHAIN.base_T_flange(joints_rad)
    np.testing.assert_allclose(CHAIN.flange_m(joints_rad), pose.translation, atol=1e-12)
