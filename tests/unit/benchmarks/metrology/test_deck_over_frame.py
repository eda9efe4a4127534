"""A quick part of ``benchmarks.metrology.deck_over_frame``: one cell, few frames."""

from copy import deepcopy

import numpy as np
import pytest

from benchmarks.metrology.deck_over_frame import Steadiness, Steady, judged, looks_of
from benchmarks.metrology.fake_station import SCENARIO
from benchmarks.metrology.loop import Setting
from fakes.scenes.deck_on_frame.scenario import DeckScenario

OVER = "60 deck over frame"


@pytest.fixture(scope="module")
def steady() -> Steady:
    """Seed 3, whose deck shows holes of its frame through its own."""
    found = Steady()
    scenario = DeckScenario.read(SCENARIO)
    for look, views in looks_of(Setting.shipped(), scenario, 3, 3, ("60 deck over frame",)):
        found.take(look, views)
    return found


@pytest.mark.figures
def test_a_deck_over_its_frame_stays_where_it_is(steady: Steady) -> None:
    assert not steady.refused
    assert steady.pairs == {OVER: 6}
    for (_, kind), rims in steady.rims.items():
        # Two thirds of one percent of a hole's diameter; a model that swings between two
        # explanations of what is seen through a hole moves a centre by 0.2 px.
        assert rims.farthest_px < 0.12, kind
        assert rims.jitter_px < 0.02, kind
        assert rims.errors.worst_px() < 0.12, kind
        assert rims.sigma_px < 0.03, kind
        assert rims.squared < 3.0, kind


def jumping() -> Steadiness:
    """Two frames, between which a centre has gone 0.1 px along x."""
    found = Steadiness()
    found.add(np.array([[0.0, 0.0], [0.1, 0.0]]), np.tile(np.eye(2) * 0.03**2, (2, 1, 1)))
    return found


def test_how_far_a_centre_jumps() -> None:
    assert jumping().farthest_px == pytest.approx(0.1)
    # The variance of x is 0.1² / 2, that of y is 0.
    assert jumping().jitter_px == pytest.approx(0.05)
    assert jumping().sigma_px == pytest.approx(0.03)


@pytest.mark.figures
def test_a_centre_that_jumps_is_judged(steady: Steady) -> None:
    steady = deepcopy(steady)
    for rims in steady.rims.values():
        rims.errors.along_px[:] = [np.zeros(2)] * rims.errors.count
    assert judged(steady)[1]
    for rims in steady.rims.values():
        rims.moved_px.extend(jumping().moved_px * 20)
    assert not judged(steady)[1]
