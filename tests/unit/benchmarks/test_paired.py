"""The difference of pairs, and how well it is known."""

import numpy as np
import pytest

from benchmarks.paired import mean_difference


def test_what_both_share_does_not_count() -> None:
    shared = np.array([10.0, 50.0, 90.0])
    mean, sigma = mean_difference(np.column_stack([shared, shared + np.array([1.0, 2.0, 3.0])]))
    assert mean == pytest.approx(2.0)
    assert sigma == pytest.approx(1.0 / np.sqrt(3.0))
