"""Looks whether a part with this serial number was finished before, and warns of it."""

from collections.abc import Awaitable, Callable

from cellctl.clock import utc_now
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.errors.line import SerialMadeBefore
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import PRODUCTION, RunHead, RunResult
from cellctl.records.store import RunStore

Warn = Callable[[CellError], Awaitable[None]]
"""Makes an alarm of a fault whose reaction is to warn."""
_FINISHED = frozenset({RunResult.GOOD, RunResult.BAD})
"""A part whose run was stopped or aborted is begun anew with the same number, rightly."""
_LOOKED_AT = 100
"""Newest runs with the serial number that are looked at. A part is not begun a hundred times: the
bound only keeps a number that stands for "unknown" from having all its runs read."""


async def warn_of_earlier_part(
    store: AsyncRunStore, recipe: Recipe, serial: str, run: int, warn: Warn
) -> None:
    """Warn when the store has a finished run of this recipe with the same serial number.

    ``run`` is the open one. The run goes on: whoever reworks a part knows. Raises the faults of the
    store.
    """
    runs = await store.do(RunStore.runs, _LOOKED_AT, serial)
    found = [head for head in runs if head.number != run and _finished(head, recipe)]
    if not found:
        return
    newest = found[0]
    ended = newest.ended or utc_now()
    more = f" and {len(found) - 1} more" if len(found) > 1 else ""
    await warn(
        SerialMadeBefore(
            f"{serial} in run {newest.number}{more}, {newest.result}, {ended:%Y-%m-%d %H:%M} UTC"
        )
    )


def _finished(head: RunHead, recipe: Recipe) -> bool:
    # A panel with several connectors has one number in the runs of several recipes.
    same = (head.process, head.recipe_id) == (recipe.process, recipe.id)
    return same and head.mode == PRODUCTION and head.result in _FINISHED
