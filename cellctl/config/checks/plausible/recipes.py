"""Recipes that an operator cannot tell apart."""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue


def recipe_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """A second recipe of one name: records and reports name the product by it."""
    ids: dict[str, int] = {}
    for index, recipe in enumerate(cell.recipes):
        other = ids.setdefault(recipe.name, recipe.id)
        if other != recipe.id:
            allowed = f"another name than that of recipe {other}: records name a product by it"
            yield ConfigIssue(f"recipes.{index}.name", repr(recipe.name), allowed)
