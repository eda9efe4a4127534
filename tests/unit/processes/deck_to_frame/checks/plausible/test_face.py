"""Thresholds that fit the shipped face are refused for a larger one, with the reason in figures."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from cellctl.config.issue import ConfigIssue
from cellctl.config.load import load_cell
from cellctl.processes.deck_to_frame.checks import mating_plan
from cellctl.processes.deck_to_frame.checks.plausible.face import face_issues
from cellctl.processes.deck_to_frame.mating import planned_settings
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.vision.features.feature_file import read_features

CONFIG = Path(__file__).parents[6] / "config"


def found(
    correction: Mapping[str, Any] | None = None,
    mating: Mapping[str, Any] | None = None,
    **changes: Any,
) -> list[ConfigIssue]:
    (recipe,) = load_cell(CONFIG / "deck.toml").recipes
    assert isinstance(recipe, DeckRecipe)
    if correction:
        changes["pose_correction"] = recipe.pose_correction.model_copy(update=correction)
    if mating:
        changes["mating"] = recipe.mating.model_copy(update=mating)
    drawing = read_features(CONFIG / recipe.deck_features)
    return list(face_issues(recipe.model_copy(update=changes), "recipes[1]", drawing))


def test_the_shipped_recipe_fits_its_face() -> None:
    assert found() == []


def test_pins_that_a_rotation_within_the_threshold_shifts_too_far() -> None:
    (issue,) = found({"threshold_about_z_deg": 0.02})
    # 0.2 mm less hypot(0.05, 0.05), at P1: hypot(480, 180) mm.
    assert issue.key == "recipes[1].pose_correction.threshold_about_z_deg"
    assert "at most 0.014" in issue.allowed
    assert "P1 is 513 mm from the middle" in issue.allowed
    assert "0.179 mm beside the 0.071 mm" in issue.allowed


def test_a_threshold_along_the_face_that_uses_up_the_limit_alone() -> None:
    (issue,) = found({"threshold_mm": 0.15})
    assert issue.key == "recipes[1].pose_correction.threshold_mm"
    assert "less than 0.141" in issue.allowed


def test_a_wide_face_whose_edge_would_carry_it_above_its_seat() -> None:
    issues = found(mating={"max_moment_n_m": 60.0}, face_mm=(1000.0, 1000.0))
    (issue,) = issues
    # hypot(0.014 deg * 500 mm, 0.006 deg * 500 mm)
    assert issue.key == "recipes[1].pose_correction.threshold_about_x_deg"
    assert "0.133 mm lower" in issue.allowed
    assert "at most 0.011" in issue.allowed


def test_a_long_face_is_told_by_the_other_angle() -> None:
    issues = found(mating={"max_moment_n_m": 60.0}, face_mm=(2000.0, 300.0))
    assert [issue.key for issue in issues] == ["recipes[1].pose_correction.threshold_deg"]


def test_a_moment_that_the_first_touch_of_a_corner_exceeds() -> None:
    (issue,) = found(mating={"max_moment_n_m": 19.0})
    assert issue.key == "recipes[1].mating.max_moment_n_m"
    assert issue.allowed.startswith("at least 20: target_force_n on a corner of the face, 0.56 m")


def test_heavier_loads_are_planned_with_their_own_mass(monkeypatch: pytest.MonkeyPatch) -> None:

    planned_kg: list[float] = []
    original = planned_settings.mating_settings

    def settings(*arguments: Any) -> Any:
        planned_kg.append(arguments[-1])
        return original(*arguments)

    monkeypatch.setattr(mating_plan, "mating_settings", settings)
    cell = load_cell(CONFIG / "deck.toml")
    assert planned_kg == [200.0]
    load = cell.robots["main"].load
    assert load is not None
    robots = {**cell.robots}
    heavier = load.model_copy(update={"mass_kg": 650.0, "not_weighed_kg": 4.0})
    robots["main"] = robots["main"].model_copy(update={"load": heavier})
    (recipe,) = cell.recipes
    assert isinstance(recipe, DeckRecipe)
    heavy = cell.model_copy(update={"robots": robots})
    assert list(mating_plan.plan_issues(heavy, recipe, "recipes[1]")) == []
    assert planned_kg[1:] == [646.0]
