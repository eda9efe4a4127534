"""Looks whether parts with these serial numbers were finished before, and warns of it."""

from collections.abc import Awaitable, Callable, Sequence

from cellctl.clock import utc_now
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.errors.line import SerialMadeBefore
from cellctl.packml.unit_command import UnitCommand
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import PRODUCTION, RunHead, RunResult
from cellctl.records.parts import RUNS_OF_A_PART
from cellctl.records.store import RunStore

Warn = Callable[[CellError], Awaitable[None]]
"""Makes an alarm of a fault whose reaction is to warn."""
_FINISHED = frozenset({RunResult.GOOD, RunResult.BAD})
"""A part whose run was stopped or aborted is begun anew with the same number, rightly."""


async def warn_of_earlier_part(
    store: AsyncRunStore, recipe: Recipe, command: UnitCommand, run: int, warn: Warn
) -> None:
    """Warn when the store has a finished run of this recipe with one of the same serial numbers.

    ``command`` names the part, and perhaps the one that it is joined to: a line that does not write
    that number anew leaves the one of the part before. ``run`` is the open run. It goes on: whoever
    reworks a part knows. Raises the faults of the store.
    """
    found = {command.serial: await store.do(RunStore.runs, RUNS_OF_A_PART, command.serial)}
    if mate := command.mate_serial:
        joined = await store.do(RunStore.runs, RUNS_OF_A_PART, mate_serial=mate)
        found[f"joined to {mate}"] = joined
    facts = [
        f"{what} {earlier}"
        for what, runs in found.items()
        if (earlier := _earlier([head for head in runs if head.number != run], recipe))
    ]
    if facts:
        await warn(SerialMadeBefore("; ".join(facts)))


def _earlier(runs: Sequence[RunHead], recipe: Recipe) -> str:
    """Words for the finished runs of a recipe, the newest by its number; empty without one."""
    finished = [head for head in runs if _finished(head, recipe)]
    if not finished:
        return ""
    newest, more = finished[0], len(finished) - 1
    ended = newest.ended or utc_now()
    others = f" and {more} more" if more else ""
    return f"in run {newest.number}{others}, {newest.result}, {ended:%Y-%m-%d %H:%M} UTC"


def _finished(head: RunHead, recipe: Recipe) -> bool:
    # A panel with several connectors has one number in the runs of several recipes.
    same = (head.process, head.recipe_id) == (recipe.process, recipe.id)
    return same and head.mode == PRODUCTION and head.result in _FINISHED
