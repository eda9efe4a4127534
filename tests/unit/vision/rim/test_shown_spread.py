"""What rims show of the spread of their image."""

from dataclasses import replace

import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.vision.rim.light import LightModel
from cellctl.vision.rim.shape import RimShape, borders
from cellctl.vision.rim.shown_spread import ShownSpread, image_spread, shown_spread
from cellctl.vision.rim.solver import RimFit, full_fit, single_image_problem
from cellctl.vision.rim.spread import ImageSpread
from tests.unit.vision.rim.test_shape import SHAPES, pixels_round

_SIGMA = np.array([0.01, 0.01, 0.08])


def fitted_bore(spread: ImageSpread, believed: ImageSpread) -> RimFit:
    """A dark bore with noise, fitted with a spread that is believed."""
    shape = SHAPES["bore"]
    pixels = replace(pixels_round(shape.centre), spread=spread)
    (rim,) = borders(pixels, shape)
    noise = np.random.default_rng(1).normal(0.0, 1.5, len(rim.outside))
    seen = replace(pixels, grey=40.0 + 140.0 * rim.outside + noise, spread=believed)
    start = RimShape(shape.centre, shape.radius, 1.0)
    problem = single_image_problem(seen, start, LightModel(), shape.radius, None)
    return full_fit(problem, start.vector)


@pytest.mark.parametrize(
    ("movement_px", "excess", "change"),
    [
        ((0.0, 0.0), 0.0, (0.0, 0.0, 0.0)),
        ((0.5, 0.0), 0.0, (0.125, 0.0, 0.0)),
        ((0.4, 0.4), 0.0, (0.0, 0.16, 0.0)),
        ((0.0, 0.0), -0.6, (0.0, 0.0, -0.6)),
        ((0.0, 0.0), 1.0, (0.0, 0.0, 1.0)),
    ],
)
def test_a_rim_shows_movement_and_focus(
    movement_px: tuple[float, float], excess: float, change: tuple[float, float, float]
) -> None:
    spread = ImageSpread(np.array(movement_px), excess)
    shown = shown_spread(fitted_bore(spread, ImageSpread()))
    # First order: a large change comes out by up to a quarter too small.
    allowed = 4.0 * shown.sigma + 0.25 * np.abs(change)
    assert (np.abs(shown.change - change) < allowed).all()
    assert shown.sigma.max() < 0.2


def test_what_is_modelled_is_not_shown_again() -> None:
    spread = ImageSpread(np.array([0.6, -0.2]), -0.5)
    shown = shown_spread(fitted_bore(spread, spread))
    assert (np.abs(shown.change) < 4.0 * shown.sigma).all()


def _rims(*changes: tuple[float, float, float]) -> list[ShownSpread]:
    return [ShownSpread(np.array(change), _SIGMA) for change in changes]


def test_the_way_of_a_movement_comes_from_all_rims() -> None:
    found = image_spread(ImageSpread(), _rims((0.01, 0.11, 0.0), (-0.01, 0.13, 0.0)))
    # A variance of 0.24 px² along 45 degrees.
    np.testing.assert_allclose(found.movement_px, np.full(2, np.sqrt(0.12)), rtol=1e-6)
    assert found.excess == 0.0


def test_a_movement_is_added_to_the_one_before() -> None:
    before = ImageSpread(np.array([0.6, 0.0]), -0.3)
    found = image_spread(before, _rims((-0.1, 0.0, 0.01), (-0.1, 0.0, 0.02)))
    np.testing.assert_allclose(found.movement_px, [0.4, 0.0], atol=1e-9)
    assert found.excess == -0.3


@pytest.mark.parametrize(
    "rims",
    [
        _rims((0.3, 0.0, -0.9)),
        _rims((0.02, 0.01, 0.1), (0.01, -0.02, -0.05)),
        _rims((0.2, 0.0, 0.0), (-0.2, 0.0, 0.0)),
        [],
    ],
    ids=["one rim", "noise", "rims that contradict each other", "none"],
)
def test_nothing_changes_without_evidence(rims: list[ShownSpread]) -> None:
    before = ImageSpread(np.array([0.2, 0.1]), -0.2)
    assert image_spread(before, rims) is before


@pytest.mark.parametrize(("shown", "most"), [(-9.0, -1.0), (9.0, 0.0)])
def test_the_excess_stays_between_a_disc_and_a_gaussian(shown: float, most: float) -> None:
    found = image_spread(ImageSpread(excess=-0.5), _rims((0.0, 0.0, shown), (0.0, 0.0, shown)))
    assert found.excess == most
    assert image_spread(found, _rims((0.0, 0.0, shown), (0.0, 0.0, shown))) is found


def test_a_spread_that_no_movement_has_is_none() -> None:
    still: Array = np.zeros(2)
    np.testing.assert_array_equal(ImageSpread().movement_px, still)
    assert not ImageSpread().moved
