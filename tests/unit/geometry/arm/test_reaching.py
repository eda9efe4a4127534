import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.arm.reaching import joints_reaching
from tests.unit.planning.deck_cell import deck_scene

ARM = deck_scene().arms["main"]


def test_the_joints_of_a_pose_are_found_again() -> None:
    rng = np.random.default_rng(1)
    taught_rad = ARM.taught_rad("deck_measure")
    for _ in range(20):
        expected_rad = taught_rad + rng.uniform(-0.15, 0.15, 6)
        found_rad = joints_reaching(ARM.chain, ARM.chain.link_frames(expected_rad)[6], taught_rad)
        assert found_rad is not None
        assert np.allclose(found_rad, expected_rad, atol=1e-7)


def test_a_pose_far_in_turn_is_found_too() -> None:
    """The rotation between both poses is more than a quarter turn."""
    near_rad = ARM.taught_rad("deck_measure")
    expected_rad = near_rad + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 2.5])
    found_rad = joints_reaching(ARM.chain, ARM.chain.link_frames(expected_rad)[6], near_rad)
    assert found_rad is not None
    assert np.allclose(found_rad, expected_rad, atol=1e-7)


def test_a_pose_out_of_reach_is_not_found() -> None:
    far = RigidTransform.from_translation([9.0, 0.0, 1.0]).as_matrix()
    assert joints_reaching(ARM.chain, far, ARM.taught_rad("home")) is None
