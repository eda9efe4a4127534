"""What the search hands out is free on the whole way, not only where the tree has looked."""

import numpy as np
import pytest

from cellctl.errors.config import NoFreeWay
from cellctl.planning.scene.cell_scene import Standpoint
from cellctl.planning.ways import search
from cellctl.planning.ways.free import is_free_way
from tests.unit.planning.deck_cell import deck_scene

SCENE = deck_scene()
AROUND = SCENE.around(
    "main",
    {
        name: [Standpoint("measuring", tuple(SCENE.arms[name].taught_rad("measuring")))]
        for name in ("aux_1", "aux_2")
    },
)
HOME, OVER = (SCENE.arms["main"].taught_rad(pose) for pose in ("home", "deck_measure"))


def test_a_line_of_the_tree_that_is_not_free_is_no_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both ends are free, and the heads are between them."""
    direct = np.vstack([HOME, OVER])
    assert not is_free_way(AROUND, direct)
    monkeypatch.setattr(search, "_tree", lambda *_: direct)
    with pytest.raises(NoFreeWay):
        search.free_way(AROUND, HOME, OVER, seed=1, search_s=1.0)
