"""By how much patterns differ from themselves, turned by half or in a mirror."""

import tracemalloc

import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.connector.arrangement import HALF_TURN, MIRROR, asymmetry_m


def by_all_shifts(points: Array, change: Array) -> float:
    """By its definition: every changed point laid on every point."""
    changed = points @ change.T
    best = np.inf
    for shift in (points[:, None] - changed[None]).reshape(-1, 2):
        apart = np.linalg.norm((changed + shift)[:, None] - points[None], axis=2)
        best = min(best, float(apart.min(axis=1).max()))
    return best


@pytest.mark.parametrize("change", [HALF_TURN, MIRROR])
@pytest.mark.parametrize("seed", range(8))
def test_it_is_the_best_of_all_shifts(seed: int, change: Array) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-5e-3, 5e-3, (int(rng.integers(3, 16)), 2))
    assert asymmetry_m(points, change) == pytest.approx(by_all_shifts(points, change), abs=1e-12)


def test_the_largest_drawing_needs_neither_gigabytes_nor_minutes() -> None:
    """Connectors may have 400 contacts; all distances at all shifts would be 25 600 000 000."""
    grid = np.array([(column, row) for row in range(20) for column in range(20)], dtype=float)
    keyed = np.delete(grid, 0, axis=0) * 1e-3
    tracemalloc.start()
    try:
        assert asymmetry_m(keyed, HALF_TURN) == pytest.approx(1e-3)
        assert asymmetry_m(grid * 1e-3, HALF_TURN) == pytest.approx(0.0, abs=1e-12)
        most_bytes = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most_bytes < 200e6
