"""The way out of a hole is the way in."""

import numpy as np
import pytest

from cellctl.cell.contact_motion.trail import Trail
from cellctl.geometry.pose import Array


def pose(x_mm: float, depth_mm: float) -> Array:
    return np.array([x_mm * 1e-3, 0.0, depth_mm * 1e-3, 0.0, 0.0, 0.0])


def test_a_descent_is_gone_back() -> None:
    trail = Trail()
    for depth_mm in np.arange(0.05, 2.0, 0.05):
        trail.note(pose(0.1 * depth_mm, depth_mm))
    out = trail.out(pose(0.2, 2.0), 1e-3)
    # It came sideways by a tenth of its depth, and leaves so.
    np.testing.assert_allclose(out[:-1, 0], 0.1 * out[:-1, 2], atol=1e-9)
    assert len(out) > 35
    assert out[-1, 2] == -1e-3


def test_what_was_deeper_is_no_longer_on_the_way() -> None:
    trail = Trail()
    for depth_mm in (0.5, 1.0, 1.5, 0.6):
        trail.note(pose(depth_mm, depth_mm))
    assert trail.out(pose(0.7, 0.7), 0.0)[1:, 0] == pytest.approx([0.6e-3, 0.5e-3, 0.5e-3])


def test_it_begins_anew_where_the_tip_came_sideways() -> None:
    trail = Trail()
    trail.note(pose(5.0, 1.0))
    trail.begin()
    trail.note(pose(0.0, 1.5))
    assert trail.out(pose(0.0, 2.0), 1e-3)[:, 0] == pytest.approx([0.0, 0.0, 0.0])
