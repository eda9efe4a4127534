import numpy as np

from benchmarks.planning.campaign import try_cell
from benchmarks.planning.cells import GREATEST_SHIFT_M, random_cell


def test_random_cells_are_drawn_by_their_seed() -> None:
    first, again, other = random_cell(5), random_cell(5), random_cell(6)
    for name, shift_m in first.heads_shift_m.items():
        assert np.array_equal(shift_m, again.heads_shift_m[name])
        assert not np.array_equal(shift_m, other.heads_shift_m[name])
        assert np.abs(shift_m).max() <= GREATEST_SHIFT_M


def test_a_cell_is_refused_with_the_true_reason() -> None:
    refused = try_cell(7)
    assert refused.reason.startswith("F126")
    assert refused.points == 0
