"""Alarms of the records: each occurrence with who acknowledged it and when."""

from datetime import timedelta
from typing import Annotated

from fastapi import APIRouter, Path, Query, Request
from pydantic import AwareDatetime, BaseModel, ConfigDict, Field

from cellctl.clock import utc_now
from cellctl.hmi.answers.alarms import AlarmList, AlarmTold, alarm_list, alarm_told
from cellctl.hmi.problems import Problem
from cellctl.hmi.routes.parameters import MOST
from cellctl.hmi.visitors.access import Asked
from cellctl.hmi.words.languages import Language
from cellctl.records.entries import Alarm
from cellctl.records.run_filter import AlarmFilter
from cellctl.records.store import RunStore

router = APIRouter(tags=["alarms"])


class AlarmSearch(BaseModel):
    """Which alarms, and how many of them."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

    limit: Annotated[int, Field(ge=1, le=200)] = 50
    """Most alarms of one answer."""
    before: Annotated[int | None, Field(ge=1, le=MOST)] = None
    """Id of the last alarm of the page before."""
    active: bool | None = None
    """True for those that nobody has acknowledged, false for the others."""
    number: Annotated[int | None, Field(ge=1, le=MOST)] = None
    """Number of the fault."""
    run: Annotated[int | None, Field(ge=1, le=MOST)] = None
    """Number of the run in which it came."""
    since: AwareDatetime | None = None
    """Came then or later."""
    until: AwareDatetime | None = None
    """Came before."""

    def wanted(self) -> AlarmFilter:
        """The same as the records ask for it."""
        return AlarmFilter(**self.model_dump(exclude={"limit"}))


@router.get("/alarms")
async def alarms(
    request: Request, _visitor: Asked, language: Language, search: Annotated[AlarmSearch, Query()]
) -> AlarmList:
    """Alarms of the records, the newest first; readable while the daemon is away.

    Those that stand now, the first one on top, are in `/status`. `POST /commands` with
    `{"request": "acknowledge", "number": …}` acknowledges all of one number.
    """
    hour = AlarmFilter(since=utc_now() - timedelta(hours=1))

    def read(store: RunStore) -> tuple[list[Alarm], int]:
        found = store.alarms(search.wanted(), search.limit)
        return found, store.alarm_count(hour)

    found, last_hour = await request.app.state.parts.archive.ask(read)
    return alarm_list(found, last_hour, language)


@router.get("/alarms/{id}")
async def alarm(
    request: Request,
    identity: Annotated[int, Path(alias="id", ge=1, le=MOST, description="Id of the occurrence.")],
    _visitor: Asked,
    language: Language,
) -> AlarmTold:
    """One alarm by the id of its occurrence; 404 when there is none."""
    found = await request.app.state.parts.archive.ask(lambda store: store.alarm(identity))
    if found is None:
        raise Problem(404, "alarm-unknown", f"there is no alarm {identity}")
    return alarm_told(found, language)
