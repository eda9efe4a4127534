"""The figures from which a recipe works, and the same cell with one of them changed."""

from typing import Any

from cellctl.config.cell import CellConfig
from cellctl.config.document.findings import validated
from cellctl.config.document.leaves import leaves
from cellctl.config.recipe import Recipe

_SENSORS = "force_sensors"


def figures(cell: CellConfig, recipe: Recipe, key: str) -> dict[str, Any]:
    """Numbers, and lists of numbers, of a recipe, its process and the force sensors, by their keys.

    ``key`` is the path of the recipe.
    """
    sections = {key: recipe.model_dump()}
    if (settings := cell.processes.get(recipe.process)) is not None:
        sections[f"processes.{recipe.process}"] = settings.model_dump()
    sections |= {f"{_SENSORS}.{name}": one.model_dump() for name, one in cell.force_sensors.items()}
    return {
        name: value
        for path, section in sections.items()
        for name, value in leaves(section, f"{path}.")
        if is_number(value) or (isinstance(value, list | tuple) and _all_numbers(value))
    }


def with_figure(
    cell: CellConfig, recipe: Recipe, key: str, name: str, value: Any
) -> tuple[CellConfig, Recipe]:
    """Cell and recipe with another value of one key; raises pydantic's ``ValidationError`` for a
    value that the key cannot have."""
    if name.startswith(f"{key}."):
        changed = _replaced(recipe.model_dump(), name[len(key) + 1 :], value)
        return cell, validated(type(recipe), changed)
    section, device, inside = name.split(".", 2)
    models = dict(getattr(cell, section))
    models[device] = validated(
        type(models[device]), _replaced(models[device].model_dump(), inside, value)
    )
    return cell.model_copy(update={section: models}), recipe


def _replaced(section: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    *tables, last = path.split(".")
    inner: Any = section
    for table in tables:
        inner = inner[int(table) if isinstance(inner, list | tuple) else table]
    whole = isinstance(inner[last], int) and isinstance(value, float)
    inner[last] = round(value) if whole else value
    return section


def is_number(value: object) -> bool:
    """Whether a value is a single number; true and false are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def _all_numbers(values: list[Any] | tuple[Any, ...]) -> bool:
    return bool(values) and all(is_number(one) for one in values)
