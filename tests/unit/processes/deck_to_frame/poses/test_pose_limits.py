"""What the recipe allows, and how near the deck may come before it is mated."""

import pytest

from cellctl.errors.robot import TargetOutOfBounds
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.faults import PartMisplaced
from cellctl.processes.deck_to_frame.poses.pose_limits import (
    is_near,
    require_clearance,
    require_near,
)
from cellctl.processes.deck_to_frame.stations import deck_recipes
from tests.unit.cell.bench import Bench


@pytest.mark.parametrize(
    ("offset", "near"),
    [
        ([0.0] * 6, True),
        ([14.0, 0, 0, 0, 0, 0], True),
        ([11.0, 11.0, 0, 0, 0, 0], False),
        ([0, 0, 0, 2.9, 0, 0], True),
        ([0, 0, 0, 0, 2.5, 2.5], False),
    ],
)
def test_the_tolerance_of_the_recipe(bench: Bench, offset: list[float], near: bool) -> None:
    recipe = deck_recipes(bench.cell.config)[0]
    measured = bench.station * pose_from_xyzabc(offset)
    assert is_near(recipe, bench.station, measured) is near
    if near:
        require_near("frame", recipe, bench.station, measured)
    else:
        with pytest.raises(PartMisplaced, match=r"frame is .* allowed 15 mm and 3°"):
            require_near("frame", recipe, bench.station, measured)


@pytest.mark.parametrize(
    ("deck", "allowed"),
    [
        ([0, 0, 25.0, 0, 0, 0], True),
        ([0, 0, 20.5, 0, 0, 0], True),
        ([0, 0, 19.5, 0, 0, 0], False),
        ([0, 0, 25.0, 0, 0.5, 0], True),  # 480 mm · 0.5° lowers the edge by 4.2 mm
        ([0, 0, 25.0, 0, 0.7, 0], False),
        ([0, 0, 25.0, 0, 0, 1.5], False),
        ([0, 0, 25.0, 45.0, 0, 0], True),
    ],
)
def test_no_corner_comes_near_the_frame(bench: Bench, deck: list[float], allowed: bool) -> None:
    recipe, features = deck_recipes(bench.cell.config)[0], bench.features()[1]
    if allowed:
        require_clearance(recipe, features, pose_from_xyzabc(deck))
    else:
        with pytest.raises(TargetOutOfBounds, match="above the frame"):
            require_clearance(recipe, features, pose_from_xyzabc(deck))
