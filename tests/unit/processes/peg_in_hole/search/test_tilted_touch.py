import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cellctl.processes.peg_in_hole.search.circles import circle_through, turned
from cellctl.processes.peg_in_hole.search.tilted_touch import leaning, tilted_dip_m

TOWARDS = np.array([1.0, 0.0])
TILT = np.radians(8)


def dip_mm(x_mm: float, y_mm: float) -> float:
    at_m = np.array([x_mm, y_mm]) * 1e-3
    return float(tilted_dip_m(at_m, TOWARDS, 3e-3, 0.02e-3, TILT)) * 1e3


def test_the_valley_grows_deeper_towards_the_hole_and_ends_at_a_wall() -> None:
    along = [dip_mm(x, 0) for x in (-5.0, -3.0, -1.0, -0.1)]
    assert along == sorted(along)
    assert along[-1] == pytest.approx(0.42, abs=0.01)  # r θ of section 3.1
    assert dip_mm(0.5, 0) == 0
    assert dip_mm(-7, 0) == 0


def test_the_valley_is_symmetric_and_has_sides() -> None:
    assert dip_mm(-1, 0.4) == pytest.approx(dip_mm(-1, -0.4))
    assert dip_mm(-1, 0.4) < dip_mm(-1, 0.0)


def test_leaning_lowers_the_side_it_leans_to() -> None:
    direction = turned(TOWARDS, 0.7)
    rim = Rotation.from_rotvec(leaning(direction, TILT)).apply([*direction, 0.0])
    assert rim[2] == pytest.approx(np.sin(TILT))  # z points into the hole


def test_circle_through_three_points_is_exact() -> None:
    centre, radius = np.array([1.0, -2.0]), 3.0
    points = np.stack([centre + radius * turned(TOWARDS, angle) for angle in (0.1, 1.0, 2.5)])
    found, found_radius, residual = circle_through(points)
    np.testing.assert_allclose(found, centre, atol=1e-9)
    assert found_radius == pytest.approx(radius)
    assert residual < 1e-9


def test_points_on_a_line_have_no_circle() -> None:
    with pytest.raises(np.linalg.LinAlgError):
        circle_through(np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]))
