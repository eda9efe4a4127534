"""Procedure 108: the stiffness is computed anew from the readings of its contacts."""

import json
from typing import Any

import numpy as np
import pytest

from cellctl.calibration.checks import all_passed
from cellctl.force.contact.commissioning import joint_stiffness
from cellctl.processes.deck_to_frame.calibrations import CONTACT_STIFFNESS
from cellctl.processes.deck_to_frame.procedures.contact_stiffness_result import (
    Touch,
    stiffness_checks,
    stiffness_record,
)
from cellctl.processes.deck_to_frame.procedures.replays import replay_stiffness
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.runtime.procedure import ProcedureOutcome
from tests.rigs.procedure_record import Kept, differing
from tests.rigs.shipped import shipped_cell


def contact(number: int) -> dict[str, Any]:
    """As ``Touch.to_input``: 600 N/mm, with some noise."""
    rng = np.random.default_rng(number)
    travel_m = 0.01 + np.linspace(0.0, 5e-5, 8)
    force_n = 6.0 + 6e5 * (travel_m - 0.01) + rng.normal(0.0, 0.3, 8)
    return {
        "travel_m": travel_m.tolist(), "force_n": force_n.tolist(),
        "peak_n": 38.0, "peak_filtered_n": 36.5,
    }  # fmt: skip


@pytest.fixture
def recipe() -> DeckRecipe:
    recipe = shipped_cell("deck.toml").recipes[0]
    assert isinstance(recipe, DeckRecipe)
    return recipe


async def measured(recipe: DeckRecipe) -> tuple[Kept, ProcedureOutcome]:
    """What the procedure keeps and finds."""
    kept = Kept()
    await kept.keep_input({"contacts": [contact(number) for number in range(3)]})
    touches = [Touch.from_input(one) for one in kept.given["contacts"]]
    estimate = joint_stiffness([touch.estimate for touch in touches])
    checks = stiffness_checks(estimate, touches, recipe.mating)
    record = stiffness_record(estimate, touches, checks, recipe_id=recipe.id, run_number=1)
    kind = CONTACT_STIFFNESS.for_recipe(recipe.id)
    kept.files["recipe.json"] = json.dumps({"recipe": recipe.model_dump(mode="json")}).encode()
    return kept, ProcedureOutcome(kind, record, all_passed(checks), (), None, "")


async def test_a_stiffness_from_the_readings_of_its_contacts(recipe: DeckRecipe) -> None:
    kept, outcome = await measured(recipe)
    assert differing(replay_stiffness, kept.run(outcome)) == {}
    kept.given["contacts"][1]["force_n"][7] += 0.5
    found = differing(replay_stiffness, kept.run(outcome))
    assert found["contacts.2.force_n.8"] == pytest.approx(0.5)
    assert found["contacts.2.stiffness_n_per_mm"] > 1.0
    assert found["stiffness_n_per_mm"] == pytest.approx(
        found["contacts.2.stiffness_n_per_mm"] / 3, rel=1e-6
    )
    assert "contacts.1.stiffness_n_per_mm" not in found


async def test_a_run_without_readings_of_contacts_has_no_stiffness(recipe: DeckRecipe) -> None:
    _, outcome = await measured(recipe)
    assert list(replay_stiffness(Kept().run(outcome))) == []
