"""Which other values of a key are less safe, as its model says beside the key."""

from collections.abc import Iterator, Mapping
from typing import Any, get_args

from pydantic import BaseModel

from cellctl.config.base import LessSafe
from cellctl.config.cell import CellConfig
from cellctl.config.recipe import Recipe


def less_safe(cell: CellConfig, recipe: Recipe, key: str, name: str) -> LessSafe | None:
    """What the key ``name`` says of itself; None where it says nothing, or no model knows it.

    ``key`` is the path of the recipe.
    """
    inside_recipe = name.startswith(f"{key}.")
    owner: Any = recipe if inside_recipe else cell
    *tables, last = name.removeprefix(f"{key}.").split(".")
    for table in tables:
        owner = _inside(owner, table)
    if not isinstance(owner, BaseModel):
        return None  # of a driver's settings the cell file holds plain values
    field = type(owner).model_fields.get(last)
    if field is None:
        return None
    marks = (*field.metadata, *_marks(field.annotation))
    return next((mark for mark in marks if isinstance(mark, LessSafe)), None)


def _inside(owner: Any, table: str) -> Any:
    match owner:
        case Mapping():
            return owner.get(table)
        case list() | tuple():
            return owner[int(table)]
        case _:
            return getattr(owner, table, None)


def _marks(annotation: Any) -> Iterator[object]:
    """What stands in every ``Annotated`` of a type, such as that of a value which may be left
    out."""
    yield from getattr(annotation, "__metadata__", ())
    for inner in get_args(annotation):
        yield from _marks(inner)
