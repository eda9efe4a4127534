"""An adjustment that cannot be solved says so by its number, whatever part of it is singular."""

from collections.abc import Sequence

import numpy as np
import pytest

from cellctl.calibration.solvers.bundle import LinearImage, adjust_bundle, place_board
from cellctl.errors.calibration import SolveFailed
from cellctl.geometry.pose import Array

POINTS = 8


class OneUnknown:
    """One number that two views share; the second view says nothing of where its board is."""

    name = "made up"
    prior = np.zeros(1)

    def __init__(self, *, blind: bool) -> None:
        self._blind = blind

    def offsets(self, state: float) -> Array:
        return np.zeros(1)

    def linearise(self, state: float) -> Sequence[Sequence[LinearImage]]:
        draws = np.random.default_rng(1)
        residuals = 0.1 * draws.standard_normal((POINTS, 2)) - state
        by_view = draws.standard_normal((POINTS, 2, 6))
        seen = LinearImage(residuals, np.ones((POINTS, 2, 1)), by_view)
        blind = LinearImage(residuals, np.ones((POINTS, 2, 1)), np.zeros((POINTS, 2, 6)))
        return [[seen], [blind if self._blind else seen]]

    def moved(self, state: float, shared: Array, views: Array) -> float:
        return state + float(shared[0])


def test_views_that_say_where_their_boards_are_can_be_adjusted() -> None:
    assert abs(adjust_bundle(OneUnknown(blind=False), 1.0).state) < 0.2


def test_a_view_that_does_not_say_it_fails_by_a_fault() -> None:
    with pytest.raises(SolveFailed, match="does not say how its board lies"):
        adjust_bundle(OneUnknown(blind=True), 1.0)
    with pytest.raises(SolveFailed, match="does not say how its board lies"):
        place_board(OneUnknown(blind=True), 1.0, 1.0)
