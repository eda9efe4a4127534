"""Reset and the force after a crash ask each arm of the process once."""

from types import SimpleNamespace
from typing import Any

import pytest

from cellctl.processes.peg_in_hole import leaving
from cellctl.processes.peg_in_hole.process import PegInHole
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.stations import PegCell, peg_recipes
from tests.rigs.shipped import shipped_cell

CELL = shipped_cell("insertion-pin.toml")


class TwoArms:
    """Has of a cell what its devices are looked up by."""

    def __init__(self) -> None:
        (recipe,) = peg_recipes(CELL)
        self.of_arm = recipe
        self.of_other = recipe.model_copy(update={"id": 2, "roles": {"force": "other_force"}})
        second = recipe.model_copy(update={"id": 3})
        recipes = (recipe, second, self.of_other)
        self.config = SimpleNamespace(recipes=recipes, processes=CELL.processes)

    def guarded_robot(self, sensor_name: str) -> object:
        return SimpleNamespace(sensor_name=sensor_name)


@pytest.mark.parametrize("asked", ["clear", "show_contact_force"])
async def test_each_arm_is_asked_once_and_for_its_own_holes(
    monkeypatch: pytest.MonkeyPatch, asked: str
) -> None:
    left: dict[str, tuple[PegRecipe, ...]] = {}

    async def leave(cell: PegCell) -> None:
        assert cell.arm.sensor_name not in left
        left[cell.arm.sensor_name] = cell.recipes

    monkeypatch.setattr(leaving, "leave_hole", leave)
    monkeypatch.setattr(leaving, "show_force_on_tip", leave)
    services: Any = SimpleNamespace(cell=TwoArms())
    await getattr(PegInHole(services), asked)()
    ids = {name: [recipe.id for recipe in recipes] for name, recipes in left.items()}
    assert ids == {"force": [1, 3], "other_force": [2]}
