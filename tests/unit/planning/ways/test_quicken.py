"""Points of a way go where it takes less time, and the way stays free."""

import numpy as np
import pytest

from cellctl.planning.scene.cell_scene import Standpoint
from cellctl.planning.ways import quicken
from cellctl.planning.ways.free import is_free_way
from cellctl.planning.ways.travel import travel_s
from tests.unit.planning.deck_cell import deck_scene

SCENE = deck_scene()
MAIN = SCENE.arms["main"]
AROUND = SCENE.around(
    "main",
    {
        name: [Standpoint("measuring", tuple(SCENE.arms[name].taught_rad("measuring")))]
        for name in ("aux_1", "aux_2")
    },
)
HOME, OVER = (MAIN.taught_rad(pose) for pose in ("home", "deck_measure"))
VIA = np.radians(SCENE.cell.robots["main"].ways[0].via_deg)


def test_a_way_becomes_quicker_and_stays_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quicken, "_TRIES", 60)
    way = np.vstack([HOME, VIA, OVER])
    quick = quicken.quickened(AROUND, way, np.random.default_rng(1))
    assert travel_s(MAIN, quick) < travel_s(MAIN, way)
    assert np.array_equal(quick[[0, -1]], [HOME, OVER])
    assert is_free_way(AROUND, quick)


def test_two_points_become_one_where_there_is_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quicken, "_TRIES", 20)
    alone = SCENE.around("main", {})
    way = np.vstack([HOME, HOME + 0.2, HOME + 0.4, HOME])
    assert len(quicken.quickened(alone, way, np.random.default_rng(1))) == 3


def test_what_is_not_free_is_not_taken_however_quick() -> None:
    way = np.vstack([HOME, VIA, OVER])
    closed = SCENE.around("main", {})
    closed.has_room = lambda *_: False  # type: ignore[method-assign]
    assert np.array_equal(quicken.quickened(closed, way, np.random.default_rng(1)), way)


def test_a_straight_way_stays_as_it_is() -> None:
    way = np.vstack([HOME, OVER])
    assert quicken.quickened(AROUND, way, np.random.default_rng(1)) is way
