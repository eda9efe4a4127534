"""How long a run will still take."""

from collections import OrderedDict

from fastapi import APIRouter, Request

from cellctl.clock import utc_now
from cellctl.hmi.answers.time_left import NOTHING, TimeLeft, UsualStep, time_left, usual_steps
from cellctl.hmi.archive import ArchiveReader
from cellctl.hmi.routes.parameters import RunNumber
from cellctl.hmi.visitors.access import Asked
from cellctl.records.entries import RunHead
from cellctl.records.outcome import result_at_end
from cellctl.records.run_filter import RunFilter

router = APIRouter(tags=["records"])
RUNS = 20
"""Good runs that are looked at: enough for a median, and few enough to follow a recipe that has
become slower or faster."""
_RECIPES_KEPT = 20


class UsualTimes:
    """What runs of a recipe and mode that came to their end take, kept until there is another one.

    Every page asks every few seconds, and whole records take longer to read than a list of them.
    Belongs to one event loop.
    """

    def __init__(self, archive: ArchiveReader) -> None:
        self._archive = archive
        self._kept: OrderedDict[tuple[int, ...], tuple[UsualStep, ...]] = OrderedDict()

    async def of(self, head: RunHead) -> tuple[tuple[UsualStep, ...], int]:
        """The usual steps for a run of this head, and how many runs say so; none without any.

        Raises ``StoreUnavailable``.
        """
        wanted = RunFilter(
            before=head.number,
            recipe=head.recipe_name,
            mode=head.mode,
            result=result_at_end(head.mode),
        )
        listed = await self._archive.listed(wanted, RUNS)
        # A recipe that was changed since may have other steps, and other times.
        alike = (one.head for one in listed if one.head.recipe_hash == head.recipe_hash)
        numbers = tuple(one.number for one in alike)
        if numbers not in self._kept:
            self._kept[numbers] = await self._archive.ask(
                lambda store: usual_steps([store.run(number).phases for number in numbers])
            )
        self._kept.move_to_end(numbers)
        while len(self._kept) > _RECIPES_KEPT:
            self._kept.popitem(last=False)
        return self._kept[numbers], len(numbers)


@router.get("/runs/{number}/time-left")
async def left(request: Request, number: RunNumber, _visitor: Asked) -> TimeLeft:
    """How long an open run will still take, by the last good ones of its recipe and mode.

    All null for a run that has ended, and while there is no good run of the recipe as it is.
    """
    parts = request.app.state.parts
    record = await parts.archive.ask(lambda store: store.run(number))
    if record.head.result is not None:
        return NOTHING
    usual, runs = await parts.usual.of(record.head)
    return time_left(record.phases, usual, runs, utc_now())
