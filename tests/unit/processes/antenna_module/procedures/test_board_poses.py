import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.procedures.board_poses import swung_poses
from cellctl.processes.antenna_module.settings import AntennaSettings

SETTINGS = AntennaSettings.model_validate(
    {
        "arm": {"rp_mm": 0.02, "rp_deg": 0.001, "absolute_error_mm": 0.26, "drift_mm": 0.0},
        "views": 30,
        "tilt_deg": 20.0,
        "turn_deg": 40.0,
        "depth_mm": 20.0,
        "shift_mm": (18.0, 6.0),
    }
)
BASE_T_FLANGE = pose_from_xyzabc([520.0, -40.0, 500.0, 0.0, 0.0, 180.0])
FLANGE_T_PIVOT = pose_from_xyzabc([110.0, 0.0, 200.0, 0.0, 0.0, 0.0])


def swings() -> list[RigidTransform]:
    """Where the middle of the board is swung to, in its own frame."""
    base_T_pivot = BASE_T_FLANGE * FLANGE_T_PIVOT
    poses = swung_poses(SETTINGS, BASE_T_FLANGE, FLANGE_T_PIVOT)
    return [base_T_pivot.inv() * pose * FLANGE_T_PIVOT for pose in poses]


def test_the_first_view_is_the_taught_pose() -> None:
    first = swings()[0]
    assert first.translation == pytest.approx([0, 0, 0], abs=1e-12)
    assert first.rotation.magnitude() == pytest.approx(0, abs=1e-9)


def test_no_view_is_beyond_the_settings() -> None:
    shifts_mm = np.array([swing.translation for swing in swings()]) / MM
    assert (np.abs(shifts_mm) <= (18.0, 6.0, 20.0)).all()
    tilts_deg = [np.degrees(np.arccos(swing.rotation.as_matrix()[2, 2])) for swing in swings()]
    assert max(tilts_deg) <= np.hypot(20.0, 20.0)


def test_views_are_spread_over_all_that_is_permitted() -> None:
    all_swings = swings()
    assert len(all_swings) == SETTINGS.views
    shifts_mm = np.array([swing.translation for swing in all_swings]) / MM
    assert (np.ptp(shifts_mm, axis=0) > np.array([18.0, 6.0, 20.0]) * 1.6).all()
    turns = Rotation.concatenate([swing.rotation for swing in all_swings]).as_euler("ZYX")
    assert (np.ptp(np.degrees(turns), axis=0) > np.array([40.0, 20.0, 20.0]) * 1.6).all()


def test_every_calibration_drives_alike() -> None:
    for one, other in zip(swings(), swings(), strict=True):
        assert one.as_matrix() == pytest.approx(other.as_matrix(), abs=0)
