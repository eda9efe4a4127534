"""Crossings of a rim and an edge against a search through the rim, and the way they push."""

import math

import numpy as np
import pytest

from fakes.world.peg.attitude import Vector3, axis_of
from fakes.world.peg.crossings import crossings
from fakes.world.peg.ellipse import Ellipse
from fakes.world.peg.face import carrying_points, height_map
from fakes.world.peg.fit import Fit
from tests.unit.fakes.world.peg.pushing import MM, pin

_RIM_M = 3.0 * MM
_UPWARDS = np.linspace(0.0, np.pi, 3601)


def _searched(tip: Vector3, axis: Vector3, edge_m: float) -> list[tuple[Vector3, int]]:
    """The first place on each side, from the lowest point up, where the rim crosses the edge; and
    zero where it goes out there counterclockwise."""
    rim = Ellipse.of_ring(tip, axis, _RIM_M)
    found = []
    for side in (1, -1):
        points = np.array([rim.point(side * angle) for angle in _UPWARDS])
        out = np.hypot(points[:, 0], points[:, 1]) > edge_m
        changes = np.flatnonzero(out[1:] != out[:-1])
        if len(changes):
            x, y, z = points[changes[0]]
            goes_out = out[changes[0] + 1] == (side > 0)
            found.append(((float(x), float(y), float(z)), 0 if goes_out else 1))
    return found


def test_the_lowest_crossing_on_each_side_is_found() -> None:
    rng = np.random.default_rng(1)
    counts = []
    for _ in range(60):
        edge_m = _RIM_M + rng.choice([0.005, 0.02, 0.05]) * MM
        tilt, bearing = rng.uniform(0.02, 0.2), rng.uniform(0.0, 2 * np.pi)
        axis = axis_of(tilt * math.cos(bearing), tilt * math.sin(bearing))
        off_m, towards = 10 ** rng.uniform(-5.0, -2.5), rng.uniform(0.0, 2 * np.pi)
        tip = (off_m * math.cos(towards), off_m * math.sin(towards), 0.0)
        ours = {one.number: one for one in crossings(tip, axis, _RIM_M, edge_m)}
        searched = _searched(tip, axis, edge_m)
        counts.append(len(searched))
        for place, number in searched:
            one = ours[number]
            assert math.hypot(one.x_m, one.y_m) == pytest.approx(edge_m, abs=2e-9)
            assert (one.x_m, one.y_m, one.z_m) == pytest.approx(place, abs=0.004 * MM)
    assert set(counts) == {0, 1, 2}


def test_a_rim_that_is_out_on_a_short_way_only_is_found() -> None:
    # e² / 4 s > c, with the offset e against the tilt and s = r tilt² / 2: a short way on each side
    tilt = math.radians(8.0)
    narrower_m = 0.5 * _RIM_M * math.sin(tilt) ** 2
    off_m = 2 * math.sqrt(narrower_m * 0.02 * MM) + 0.0002 * MM
    tip, axis = (-off_m, 0.0, 0.0), axis_of(0.0, tilt)
    first, second = crossings(tip, axis, _RIM_M, _RIM_M + 0.02 * MM)
    assert {first.number, second.number} == {0, 1}
    for one in (first, second):
        assert math.hypot(one.x_m, one.y_m) == pytest.approx(_RIM_M + 0.02 * MM, abs=1e-9)
    assert first.y_m == pytest.approx(-second.y_m)


_PLUG = Fit(3.0 * MM, 3.02 * MM, 10.0 * MM, outer_radius_m=5.0 * MM, proud_m=5.0 * MM)


@pytest.mark.parametrize(
    ("fit", "places", "farthest_mm"),
    [
        pytest.param(pin(0.02, 0.0), {1, 2}, 0.5, id="mouth of a tight hole"),
        pytest.param(pin(0.05, 0.0), {1, 2}, 3.0, id="mouth"),
        pytest.param(_PLUG, {3, 4}, 7.5, id="outer edge"),
        pytest.param(_PLUG, {5}, 7.5, id="outer edge below the bottom"),
    ],
)
def test_an_edge_pushes_up_the_slope_of_the_height_map(
    fit: Fit, places: set[int], farthest_mm: float
) -> None:
    rng, step_m, met = np.random.default_rng(2), 1e-8, 0
    for _ in range(400):
        tilt_x, tilt_y = rng.uniform(-0.15, 0.15, 2)
        x, y = rng.uniform(-farthest_mm * MM, farthest_mm * MM, 2)
        points = [*carrying_points(fit, (x, y, 0.0), axis_of(tilt_x, tilt_y))]
        if not points:
            continue
        place, *_, push = min(points, key=lambda point: point[3])
        if place not in places:
            continue
        met += 1
        slope_x, slope_y = (
            (
                height_map(fit, x + dx, y + dy, tilt_x, tilt_y)
                - height_map(fit, x - dx, y - dy, tilt_x, tilt_y)
            )
            / (2 * step_m)
            for dx, dy in ((step_m, 0.0), (0.0, step_m))
        )
        assert np.linalg.norm(push) == pytest.approx(1.0)
        assert (push[0] / push[2], push[1] / push[2]) == pytest.approx(
            (-slope_x, -slope_y), rel=0.01, abs=1e-3
        )
    assert met > 20
