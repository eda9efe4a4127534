"""Boxes of the heads' arms, however many zones each of them shares with the main arm."""

import pytest

from cellctl.config.zones import ZoneConfig, ZoneShare
from cellctl.processes.deck_to_frame.checks.shared_zones import unlike_box_remarks
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from tests.rigs.shipped import shipped_cell

CELL = shipped_cell("deck.toml")
BESIDE_1, BESIDE_2 = (CELL.zones[f"beside_head_{number}"] for number in (1, 2))


def named(zones: dict[str, ZoneConfig]) -> list[str]:
    (recipe,) = CELL.recipes
    assert isinstance(recipe, DeckRecipe)
    return [one.key for one in unlike_box_remarks(CELL.model_copy(update={"zones": zones}), recipe)]


def shrunk(zone: ZoneConfig, arm: str, by_mm: float) -> ZoneConfig:
    share = zone.robots[arm]
    low = (share.min_mm[0] + by_mm, *share.min_mm[1:])
    other = ZoneShare.model_validate(share.model_dump() | {"min_mm": low})
    return zone.model_copy(update={"robots": {**zone.robots, arm: other}})


@pytest.mark.parametrize("last", [True, False])
def test_a_second_box_of_one_arm_makes_the_other_arm_none_too_few(last: bool) -> None:
    second = {"rack": shrunk(BESIDE_1, "aux_1", 500.0)}
    zones = {"beside_head_1": BESIDE_1, "beside_head_2": BESIDE_2}
    assert named(zones | second if last else second | zones) == []


def test_each_box_without_a_like_one_is_named() -> None:
    zones = {
        "beside_head_1": BESIDE_1,
        "beside_head_2": shrunk(BESIDE_2, "aux_2", 300.0),
        "rack": shrunk(BESIDE_2, "aux_2", 400.0),
    }
    assert named(zones) == ["zones.beside_head_2.robots.aux_2", "zones.rack.robots.aux_2"]


@pytest.mark.parametrize("zones", [{}, {"beside_head_1": BESIDE_1}])
def test_one_box_or_none_has_nothing_to_differ_from(zones: dict[str, ZoneConfig]) -> None:
    assert named(zones) == []
