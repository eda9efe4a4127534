import numpy as np
import pytest

from cellctl.force.gravity.poses import PoseRole
from tests.rigs.payload_world import MATING, PIVOT, cone


def test_the_plan_starts_and_ends_at_the_mating_orientation() -> None:
    poses = cone()
    assert poses[0].role is PoseRole.FIT
    assert poses[-1].role is PoseRole.REPEAT
    for pose in (poses[0], poses[-1]):
        np.testing.assert_allclose(pose.base_T_flange.as_matrix(), MATING.as_matrix(), atol=1e-12)
    assert sum(pose.role is PoseRole.FIT for pose in poses) == 12
    assert sum(pose.role is PoseRole.HOLD_OUT for pose in poses) == 4


def test_poses_tilt_about_horizontal_base_axes_within_the_cone() -> None:
    poses = cone(half_angle_deg=12.0)
    tilts = [pose.base_T_flange.rotation * MATING.rotation.inv() for pose in poses]
    vectors = np.array([tilt.as_rotvec() for tilt in tilts])
    np.testing.assert_allclose(vectors[:, 2], 0.0, atol=1e-12)
    angles = np.rad2deg(np.linalg.norm(vectors, axis=1))
    assert angles.max() == pytest.approx(12.0)
    azimuths = np.sort(np.arctan2(vectors[1:, 1], vectors[1:, 0]))
    assert np.diff(azimuths).max() < np.pi / 2, "the tilts leave a side of the cone empty"


def test_the_pivot_stays_where_it_is() -> None:
    for pose in cone():
        np.testing.assert_allclose(pose.base_T_flange.apply(PIVOT), MATING.apply(PIVOT), atol=1e-12)
