"""The plan of views: it sees the board from everywhere, and always the same way."""

import numpy as np
import pytest

from cellctl.procedures.calibration_poses import DISTANCE_CHANGES_M, TILTS_DEG, stereo_views

PIVOT = np.array([0.0, 0.0, 0.5])


def test_the_first_view_is_the_present_pose_and_the_plan_is_fixed() -> None:
    views = stereo_views(24, PIVOT)
    assert len(views) == 24
    np.testing.assert_array_equal(views[0].as_matrix(), np.eye(4))
    again = stereo_views(24, PIVOT)
    assert all(
        (one.as_matrix() == two.as_matrix()).all() for one, two in zip(views, again, strict=True)
    )


def test_every_view_looks_at_the_board() -> None:
    for view in stereo_views(24, PIVOT)[1:]:
        seen_m = view.inv().apply(PIVOT)
        sideways_m = np.abs(seen_m[:2]).max()
        assert sideways_m <= 0.05 + 1e-12
        nearest = 0.5 - max(DISTANCE_CHANGES_M)
        assert nearest - 1e-12 <= seen_m[2] <= 0.5 - min(DISTANCE_CHANGES_M) + 1e-12


def test_tilts_and_turns_are_spread() -> None:
    views = stereo_views(24, PIVOT)[1:]
    axes = np.array([view.rotation.apply([0.0, 0.0, 1.0]) for view in views])
    tilts_deg = np.degrees(np.arccos(axes[:, 2]))
    assert tilts_deg.max() < np.hypot(*(max(TILTS_DEG),) * 2)
    assert (axes[:, :2].max(axis=0) > 0.3).all()
    assert (axes[:, :2].min(axis=0) < -0.3).all()
    turned = [abs(view.rotation.as_euler("ZYX", degrees=True)[0]) > 45 for view in views]
    assert sum(turned) == pytest.approx(len(views) / 2, abs=1)
