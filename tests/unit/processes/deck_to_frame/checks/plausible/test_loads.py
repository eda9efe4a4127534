"""Forces and accelerations of a recipe against the load that hangs on the arm."""

from pathlib import Path

import pytest

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.config.load import load_cell
from cellctl.processes.deck_to_frame.checks.plausible.loads import load_issues, load_remarks
from cellctl.processes.deck_to_frame.recipe import DeckRecipe

CONFIG = Path(__file__).parents[6] / "config"


def found(mass_kg: float) -> list[ConfigIssue]:
    cell = load_cell(CONFIG / "deck.toml")
    (recipe,) = cell.recipes
    assert isinstance(recipe, DeckRecipe)
    main = cell.robots["main"]
    assert main.load is not None
    load = main.load.model_copy(update={"mass_kg": mass_kg, "not_weighed_kg": 0.0})
    robots = {**cell.robots, "main": main.model_copy(update={"load": load})}
    return list(load_issues(cell.model_copy(update={"robots": robots}), recipe, "recipes[1]"))


def test_the_shipped_load_begins_to_move_without_being_taken_for_a_contact() -> None:
    assert found(200.0) == []


def test_a_heavy_load_must_begin_to_move_more_slowly() -> None:
    (issue,) = found(650.0)
    assert issue.key == "recipes[1].mating.acceleration_mm_s2"
    # 20 N / 2 / 650 kg
    assert issue.allowed.startswith("at most 15: 650 kg that begin to move")


def with_mating(**changed: float | None) -> tuple[CellConfig, DeckRecipe]:
    cell = load_cell(CONFIG / "deck.toml")
    (recipe,) = cell.recipes
    assert isinstance(recipe, DeckRecipe)
    mating = recipe.mating.model_copy(update=changed)
    return cell, recipe.model_copy(update={"mating": mating})


def refused_speed(issues: list[ConfigIssue], most: str | None) -> ConfigIssue | None:
    """The only issue, which names the greatest speed; None where that speed may be driven."""
    if most is None:
        assert issues == []
        return None
    (issue,) = issues
    assert issue.key == "recipes[1].mating.fast_speed_mm_s"
    assert issue.allowed.startswith(f"at most {most}: a deck that is thicker than stated")
    return issue


@pytest.mark.parametrize(
    ("speed_mm_s", "latency_ms", "most"),
    [(9.5, 300.0, None), (12.0, 300.0, "9.5"), (5.0, 700.0, "4.1")],
)
def test_the_fast_travel_presses_no_more_than_the_sensor_carries_beside_the_weight(
    speed_mm_s: float, latency_ms: float, most: str | None
) -> None:
    """A deck that is thicker than stated: 20 N and 1000 N/mm times speed and latency, of 5 kN."""
    cell, recipe = with_mating(
        fast_speed_mm_s=speed_mm_s, stop_latency_ms=latency_ms, unexpected_force_n=None
    )
    issues = list(load_issues(cell, recipe, "recipes[1]"))
    refused_speed(issues, most)


@pytest.mark.parametrize(
    ("carried_n", "speed_mm_s", "most"),
    # 20 N and 1.05 times 1000 N/mm times 0.3 s times the speed
    [
        (1600.0, 5.0, None),
        (1590.0, 5.0, "4.9"),
        (650.0, 5.0, "2"),
        (650.0, 2.0, None),
        (50.0, 5.0, "0.095"),
    ],
)
def test_the_fast_travel_presses_no_more_than_the_parts_take(
    carried_n: float, speed_mm_s: float, most: str | None
) -> None:
    cell, recipe = with_mating(unexpected_force_n=carried_n, fast_speed_mm_s=speed_mm_s)
    issues = list(load_issues(cell, recipe, "recipes[1]"))
    issue = refused_speed(issues, most)
    if issue is not None:
        assert issue.allowed.endswith(f"unexpected_force_n is {carried_n:.0f}")


def test_parts_that_take_more_than_the_sensor_are_remarked_on() -> None:
    cell, recipe = with_mating(unexpected_force_n=16_000.0)
    (remark,) = load_remarks(cell, recipe, "recipes[1]")
    assert remark.key == "recipes[1].mating.unexpected_force_n"
    assert remark.allowed == "never acts: the sensor carries 3038 N beside the weight"


def test_what_the_parts_take_is_asked_for() -> None:
    cell, recipe = with_mating(unexpected_force_n=None)
    (remark,) = load_remarks(cell, recipe, "recipes[1]")
    assert remark.key == "recipes[1].mating.unexpected_force_n"
    assert "1595 N at fast_speed_mm_s" in remark.allowed


def test_a_deck_that_an_empty_gripper_is_not_told_from_is_remarked_on() -> None:
    cell, recipe = with_mating(max_untared_force_n=80.0)
    assert list(load_remarks(cell, recipe, "recipes[1]")) == []
    small = recipe.model_copy(update={"face_mm": (500.0, 400.0)})
    (remark,) = load_remarks(cell, small, "recipes[1]")
    assert remark.key == "recipes[1].mating.max_untared_force_n"
    assert "hides 8.2 kg: a deck of this face and thickness weighs 8.1 kg" in remark.allowed
    cell, recipe = with_mating(max_untared_force_n=79.0)
    small = recipe.model_copy(update={"face_mm": (500.0, 400.0)})
    assert list(load_remarks(cell, small, "recipes[1]")) == []
