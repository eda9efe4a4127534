"""Height of a tilted peg over a plate with a hole against the closed form, and against a search
through all points of its bottom."""

import math

import numpy as np
import pytest

from fakes.world.frames import Array
from fakes.world.peg.attitude import axis_of
from fakes.world.peg.face import height_map
from fakes.world.peg.fit import Fit
from tests.unit.fakes.world.peg.pushing import MM, pin, plug, reach_into_plate_m


def _searched(fit: Fit, x_m: float, y_m: float, tilt_x: float, tilt_y: float) -> float:
    """The highest tip at which some point of the bottom disc lies on the ring of the face."""
    sx, sy, sz = axis_of(tilt_x, tilt_y)
    heights = []
    for radius, count in ((fit.rim_radius_m, 40_000), (fit.rim_radius_m * 0.999, 4_000)):
        heights.append(_highest(fit, (x_m, y_m), np.array([sx, sy, sz]), radius, count))
    return max(heights)


def _highest(fit: Fit, tip: tuple[float, float], s: Array, radius: float, count: int) -> float:
    turn = np.linspace(0, 2 * np.pi, count, endpoint=False)
    a = np.array([s[2], 0.0, -s[0]]) / math.hypot(s[0], s[2])
    rim = radius * (np.outer(np.cos(turn), a) + np.outer(np.sin(turn), np.cross(s, a)))
    rho = np.hypot(rim[:, 0] + tip[0], rim[:, 1] + tip[1])
    over = (rho >= fit.mouth_radius_m) & (rho <= fit.outer_radius_m)
    return float((-rim[over, 2]).max(initial=-math.inf))


@pytest.mark.parametrize("tilt_deg", [3.0, 8.0, 12.0])
@pytest.mark.parametrize("bearing_deg", [0.0, 20.0, 75.0, 180.0])
def test_the_map_is_that_of_all_points_of_the_rim(tilt_deg: float, bearing_deg: float) -> None:
    fit, tilt = pin(0.02, 0.0), math.radians(tilt_deg)
    for distance_mm in (0.5, 1.5, 3.0, 5.5, 7.0):
        x = distance_mm * MM * math.cos(math.radians(bearing_deg))
        y = distance_mm * MM * math.sin(math.radians(bearing_deg))
        for lean in ((0.0, tilt), (0.6 * tilt, -0.8 * tilt)):
            assert height_map(fit, x, y, *lean) == pytest.approx(
                _searched(fit, x, y, *lean), abs=1e-6
            )


def test_the_valley_has_the_depth_of_the_closed_form() -> None:
    # dip = r tilt (1 - sin(|bearing| + asin(e / 2r))) for a clearance that is small against e
    radius, tilt = 3.0 * MM, math.radians(8.0)
    fit = pin(0.0001, 0.0)
    on_face = height_map(fit, 10 * MM, 0.0, 0.0, tilt)
    assert on_face == pytest.approx(radius * math.sin(tilt))
    for e_mm in (0.5, 1.0, 2.0, 4.0):
        for bearing_deg in (0.0, 10.0, 25.0):
            bearing = math.radians(bearing_deg)
            x, y = -e_mm * MM * math.cos(bearing), e_mm * MM * math.sin(bearing)
            dip = on_face - height_map(fit, x, y, 0.0, tilt)
            form = radius * tilt * (1 - math.sin(bearing + math.asin(e_mm / 6.0)))
            assert dip == pytest.approx(form, abs=0.01 * MM)


def test_in_front_of_the_hole_a_tilted_peg_feels_nothing_of_it() -> None:
    fit, tilt = pin(0.02, 0.0), math.radians(8.0)
    on_face = height_map(fit, 10 * MM, 0.0, 0.0, tilt)
    assert height_map(fit, 0.5 * MM, 0.0, 0.0, tilt) == pytest.approx(on_face, abs=1e-9)


def test_over_the_hole_nothing_carries_the_peg() -> None:
    assert height_map(pin(0.02, 0.0), 0.01 * MM, 0.0, 0.0, 0.0) == -math.inf
    assert height_map(pin(0.02, 0.0), 0.03 * MM, 0.0, 0.0, 0.0) == pytest.approx(0.0)


def test_chamfers_guide_the_peg_down_by_what_it_is_nearer() -> None:
    # 45°: half a millimetre nearer is half a millimetre deeper
    fit = pin(0.02, 0.5)
    near, far = (height_map(fit, x * MM, 0.0) for x in (0.3, 0.8))
    assert far - near == pytest.approx(0.5 * MM, abs=1e-9)


def test_beyond_the_outer_edge_a_plug_finds_no_face() -> None:
    tilt = math.radians(4.0)
    assert height_map(plug(), 31.0 * MM, 0.0, 0.0, tilt) == -math.inf
    # The outer edge below the bottom carries it where its lowest point is over the edge.
    assert 0 < height_map(plug(), 10.0 * MM, 0.0, 0.0, tilt) < 14 * MM * math.sin(tilt)


def _lowered(fit: Fit, x_m: float, y_m: float, tilt: tuple[float, float]) -> float:
    """The height at which no point of wall and chamfer is inside the plate any more."""
    low, high = -3.0 * MM, 1.0 * MM
    for _ in range(18):
        middle = (low + high) / 2
        inside = reach_into_plate_m(fit, (x_m, y_m, middle, *tilt, 0.0)) > 0
        low, high = (middle, high) if inside else (low, middle)
    return high


@pytest.mark.parametrize("tilt_deg", [0.5, 4.0, 8.0])
def test_with_chamfers_the_map_is_that_of_all_points_of_the_peg(tilt_deg: float) -> None:
    fit, rng = pin(0.05), np.random.default_rng(1)
    for _ in range(10):
        x, y = rng.uniform(-3.0 * MM, 3.0 * MM, 2)
        bearing = rng.uniform(0.0, 2 * np.pi)
        tilt = math.radians(tilt_deg)
        lean = (tilt * math.cos(bearing), tilt * math.sin(bearing))
        found = height_map(fit, x, y, *lean)
        assert found == pytest.approx(_lowered(fit, x, y, lean), abs=0.003 * MM)
