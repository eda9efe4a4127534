"""Where a tilted peg meets the wall of a hole, against a search all round."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from fakes.world.frames import Array
from fakes.world.peg.attitude import Vector3, axis_of
from fakes.world.peg.tilted import edge_azimuths, looks_round, rim_points
from tests.unit.fakes.world.peg.pushing import MM, pin

_EDGE_M, _RIM_M = 3.02 * MM, 3.0 * MM
_AZIMUTH = 2 * np.pi * np.arange(3600) / 3600
_STEP_M = 1e-8

Drawn = tuple[tuple[float, float], Vector3]


def _drawn() -> list[Drawn]:
    """Offsets up to 0.1 mm, and axes of tilts from 0.02 to 0.2 rad."""
    rng = np.random.default_rng(1)
    found: list[Drawn] = []
    for _ in range(100):
        tilt, bearing = rng.uniform(0.02, 0.2), rng.uniform(0.0, 2 * np.pi)
        x, y = rng.uniform(-0.07 * MM, 0.07 * MM, 2)
        found.append(
            ((float(x), float(y)), axis_of(tilt * math.cos(bearing), tilt * math.sin(bearing)))
        )
    return found


def _from_axis_m(ex: Array, ey: Array, offset: tuple[float, float], axis: Vector3) -> Array:
    """Distance of points of the edge from the axis of the peg."""
    lever = np.column_stack([_EDGE_M * ex - offset[0], _EDGE_M * ey - offset[1], 0.0 * ex])
    along = lever @ np.array(axis)
    return np.asarray(np.linalg.norm(lever - np.outer(along, axis), axis=1))


def _radius_of_turning_m(
    towards: Callable[[float, float], tuple[float, float]], ex: float, ey: float
) -> float:
    """By the change of a direction when the peg moves across it."""
    azimuths = []
    for step in (_STEP_M, -_STEP_M):
        x, y = towards(-step * ey, step * ex)
        azimuths.append(math.atan2(y, x))
    turned = (azimuths[0] - azimuths[1] + math.pi) % (2 * math.pi) - math.pi
    return 2 * _STEP_M / turned


@pytest.mark.parametrize(("offset", "axis"), _drawn())
def test_points_of_an_edge_are_deepest_in_the_wall(
    offset: tuple[float, float], axis: Vector3
) -> None:
    searched_m = _from_axis_m(np.cos(_AZIMUTH), np.sin(_AZIMUTH), offset, axis).min()
    distances_m = []
    for number, (ex, ey, around, along) in enumerate(edge_azimuths(_EDGE_M, offset, axis)):
        azimuth = math.atan2(ey, ex) + np.array([0.0, -0.01, 0.01])
        at, *beside = _from_axis_m(np.cos(azimuth), np.sin(azimuth), offset, axis)
        assert at <= min(beside)
        distances_m.append(at)
        lever = (_EDGE_M * ex - offset[0], _EDGE_M * ey - offset[1])
        assert along == pytest.approx(lever[0] * axis[0] + lever[1] * axis[1], abs=1e-9)

        def towards(dx: float, dy: float, number: int = number) -> tuple[float, float]:
            moved = (offset[0] + dx, offset[1] + dy)
            x, y, *_ = [*edge_azimuths(_EDGE_M, moved, axis)][number]
            return x, y

        assert around == pytest.approx(_radius_of_turning_m(towards, ex, ey), rel=0.03)
    assert min(distances_m) <= searched_m + 1e-12


@pytest.mark.parametrize(("offset", "axis"), _drawn())
def test_points_of_a_rim_are_farthest_from_the_hole(
    offset: tuple[float, float], axis: Vector3
) -> None:
    a = np.array([axis[2], 0.0, -axis[0]]) / math.hypot(axis[0], axis[2])
    b = np.cross(axis, a)
    ring = _RIM_M * (np.outer(np.cos(_AZIMUTH), a) + np.outer(np.sin(_AZIMUTH), b))
    searched_m = np.hypot(ring[:, 0] + offset[0], ring[:, 1] + offset[1]).max()
    points = [*rim_points((*offset, 0.0), axis, _RIM_M)]
    for number, (x, y, z, rho, around) in enumerate(points):
        arm = np.array([x - offset[0], y - offset[1], z])
        assert np.linalg.norm(arm) == pytest.approx(_RIM_M)
        assert arm @ np.array(axis) == pytest.approx(0.0, abs=1e-12)
        assert rho == pytest.approx(math.hypot(x, y))

        def towards(dx: float, dy: float, number: int = number) -> tuple[float, float]:
            moved = (offset[0] + dx, offset[1] + dy, 0.0)
            x, y, *_ = [*rim_points(moved, axis, _RIM_M)][number]
            return x, y

        turns_at_m = _radius_of_turning_m(towards, x / rho, y / rho)
        assert around == pytest.approx(turns_at_m, rel=0.03, abs=1e-9)
    assert max(point[3] for point in points) >= searched_m - 1e-12


def test_in_the_middle_both_sides_are_alike() -> None:
    axis = axis_of(0.0, math.radians(8.0))
    (ax, ay, *_), (bx, by, *_) = edge_azimuths(_EDGE_M, (0.0, 0.0), axis)
    assert (ax, ay) == pytest.approx((1.0, 0.0))
    assert (bx, by) == pytest.approx((-1.0, 0.0))
    (px, py, _, rho, _), (qx, qy, *_) = rim_points((0.0, 0.0, 0.0), axis, _RIM_M)
    # The end of the peg is narrower along its tilt, so it is farthest out across it.
    assert (px, py, rho) == pytest.approx((0.0, _RIM_M, _RIM_M))
    assert (qx, qy) == pytest.approx((0.0, -_RIM_M))


@pytest.mark.parametrize(
    ("clearance_mm", "tilt_deg", "seems_round"),
    [(0.02, 0.0, True), (0.02, 1.0, True), (0.02, 2.0, False), (0.2, 4.0, True), (0.2, 8.0, False)],
)
def test_a_peg_looks_round_by_its_clearance(
    clearance_mm: float, tilt_deg: float, *, seems_round: bool
) -> None:
    # Its section is longer by r tilt² / 2: 0.0005 mm for 1°, 0.029 mm for 8°.
    assert looks_round(pin(clearance_mm), axis_of(0.0, math.radians(tilt_deg))) == seems_round
