"""Alarms as the records have them: each time that a fault came is one of its own."""

from collections.abc import Sequence

from cellctl.errors import CellError
from cellctl.fault_catalogue import known_fault
from cellctl.hmi.answers.form import Form, Time
from cellctl.records.entries import Alarm
from cellctl.translations import fault_words, spoken


class AlarmTold(Form):
    """One occurrence of a fault or warning."""

    id: int
    """Number of this occurrence; a later one has a higher number."""
    number: int
    """Number of the fault, as in `/faults/{number}`."""
    text: str
    """The fault with the facts of this occurrence."""
    cause: str
    remedy: str
    reaction: str
    """What it does to the cell: `abort`, `stop`, `hold` or `warn`."""
    time: Time
    run: int | None
    """Number of the run in which it came; null outside of runs."""
    active: bool
    """Nobody has acknowledged it."""
    acknowledged: Time | None
    acknowledged_by: str | None


class AlarmList(Form):
    """Alarms, the newest first."""

    alarms: tuple[AlarmTold, ...]
    last_hour: int
    """How many came in the last hour, whatever was asked for."""


def alarm_told(alarm: Alarm, language: str) -> AlarmTold:
    """An alarm with cause and remedy of its fault."""
    # It may be of a process that is not installed any more.
    known = known_fault(alarm.number) or CellError
    words = fault_words(known, language)
    return AlarmTold(
        id=alarm.id,
        number=alarm.number,
        text=spoken(alarm.text, language),
        cause=words.cause,
        remedy=words.remedy,
        reaction=known.reaction.name.lower(),
        time=alarm.time,
        run=alarm.run,
        active=alarm.acknowledged is None,
        acknowledged=alarm.acknowledged,
        acknowledged_by=alarm.acknowledged_by,
    )


def alarm_list(found: Sequence[Alarm], last_hour: int, language: str) -> AlarmList:
    """The answer to a search."""
    told = tuple(alarm_told(alarm, language) for alarm in found)
    return AlarmList(alarms=told, last_hour=last_hour)
