"""What the recipes of all processes have in common."""

from cellctl.config.recipe import Recipe, first_of_each


def recipe(number: int, sensor: str) -> Recipe:
    return Recipe(process="any", id=number, name=f"part {number}", roles={"force": sensor})


def test_each_device_has_its_first_recipe_once() -> None:
    recipes = [recipe(1, "left"), recipe(2, "right"), recipe(3, "left"), recipe(4, "right")]
    assert {one.id for one in first_of_each(recipes, "force")} == {1, 2}
    assert first_of_each([], "force") == []
