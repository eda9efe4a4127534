"""What was done before with the part of a run: a part that was pressed and given up looks like any
other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING

from cellctl.records.entries import PRODUCTION, RunHead
from cellctl.records.parts import RUNS_OF_A_PART
from cellctl.records.report.text import when

if TYPE_CHECKING:
    # Lists of runs are shown without the database layer, which takes long to load.
    from cellctl.records.store import RunStore

_NAMED = 6
"""That stand on a page one by one; of further ones their number is said."""


@dataclass(frozen=True, slots=True)
class RunBefore:
    """An earlier run with the same serial number."""

    number: int
    recipe: str
    result: str | None
    ended: datetime | None
    step: str
    """The step that was begun last; empty without any."""
    fault: str


def runs_before(store: "RunStore", head: RunHead) -> tuple[RunBefore, ...]:
    """Earlier runs of Production with the serial number of this one, the newest first.

    Of the same store, and of any process and recipe: whatever has touched the part. A dry run ends
    before the first contact.
    """
    if not head.serial or head.mode != PRODUCTION:
        return ()
    found = store.runs(RUNS_OF_A_PART, head.serial)
    return tuple(
        _of(store, one) for one in found if one.number < head.number and one.mode == PRODUCTION
    )


def _of(store: "RunStore", head: RunHead) -> RunBefore:
    phase = store.last_phase(head.number)
    step = "" if phase is None else f"{phase.number}, {phase.label}"
    return RunBefore(head.number, head.recipe_name, head.result, head.ended, step, head.fault or "")


def words_of_runs_before(runs: Sequence[RunBefore]) -> Iterator[str]:
    """One line for each; the oldest of many only by their number."""
    for one in runs[:_NAMED]:
        step = f", last step {one.step}" if one.step else ""
        fault = f": {one.fault}" if one.fault else ""
        result = one.result or "not closed"
        yield f"run {one.number}, {one.recipe}, {result}, {when(one.ended)}{step}{fault}"
    if len(runs) > _NAMED:
        yield f"and {len(runs) - _NAMED} more"
