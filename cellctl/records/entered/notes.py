"""Notes on a run: its surroundings, which no device of the cell measures, and remarks of people.

They are entries of the audit log, which seals each of them, and may come after the run was closed.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from cellctl.errors.records.store import ValueRefused
from cellctl.records.entered.said_by import BY
from cellctl.records.entries import AuditEntry, Verdict
from cellctl.records.figures import Limit

if TYPE_CHECKING:
    # The list of runs, which loads this module too, does not wait for the database.
    from cellctl.records.store import RunStore

NOTE = "note"
"""Action of the audit log."""
_RUN, _INSTRUMENT, _REMARK = "run", "instrument", "remark"


_DRIEST_PERCENT = 2.0
"""No hall in which people assemble is drier; below it a value is a share of one, as many
instruments show it."""


@dataclass(frozen=True, slots=True)
class Surrounding:
    """One quantity of the air round a cell."""

    key: str
    """Key of the note in the detail of the audit log; it ends in the unit."""
    label: str
    unit: str
    plausible: Limit


SURROUNDINGS = (
    Surrounding("temperature_deg_c", "temperature", "°C", Limit(-20.0, 60.0)),
    Surrounding("humidity_percent", "relative humidity", "%", Limit(_DRIEST_PERCENT, 100.0)),
    Surrounding("pressure_hpa", "air pressure", "hPa", Limit(700.0, 1100.0)),
)


@dataclass(frozen=True, slots=True)
class SurroundingReading:
    """A value with who has read it, and from what."""

    surrounding: Surrounding
    value: float
    entry: AuditEntry

    @property
    def instrument(self) -> str:
        """Name of the instrument; empty where nobody named one."""
        return str(self.entry.detail.get(_INSTRUMENT, ""))


def add_note(
    store: "RunStore",
    run: int,
    actor: str,
    by: str,
    values: Mapping[str, float],
    *,
    instrument: str = "",
    remark: str = "",
) -> None:
    """Keep values by the keys of ``SURROUNDINGS``, a remark, or both.

    ``actor`` is the user as the system knows them, ``by`` the name that they typed.
    Raises ``RunUnknown``, and ``ValueRefused`` for what cannot be so or says nothing.
    """
    if not by or not (values or remark):
        raise ValueRefused("a note needs who made it, and a value or a remark")
    by_key = {one.key: one for one in SURROUNDINGS}
    for key, value in values.items():
        limit, unit = by_key[key].plausible, by_key[key].unit
        if limit.judge(value) is not Verdict.PASS:
            allowed = f"allowed {limit.lower:g} to {limit.upper:g}"
            if unit == "%" and 0.0 < value <= 1.0:
                allowed += f"; did you mean {100.0 * value:g} %?"
            raise ValueRefused(f"{by_key[key].label} {value:g} {unit}, {allowed}")
    store.run(run)
    texts = {_INSTRUMENT: instrument, _REMARK: remark}
    given = {name: text for name, text in texts.items() if text}
    store.audit(actor, NOTE, {_RUN: run, BY: by, **values, **given})


def notes_of(run: int, audit: Sequence[AuditEntry]) -> tuple[AuditEntry, ...]:
    """The notes on one run, oldest first; ``audit`` is the whole audit log."""
    return tuple(one for one in audit if one.action == NOTE and one.detail.get(_RUN) == run)


def surroundings(notes: Sequence[AuditEntry]) -> dict[str, SurroundingReading]:
    """The newest value of each quantity by its key: an earlier one may have been mistyped."""
    return {
        one.key: SurroundingReading(one, float(entry.detail[one.key]), entry)
        for entry in notes
        for one in SURROUNDINGS
        if one.key in entry.detail
    }


def remark_of(entry: AuditEntry) -> str:
    """What a note says in words; empty where it holds values alone."""
    return str(entry.detail.get(_REMARK, ""))


def note_words(entry: AuditEntry) -> str:
    """A note in one line, without who and when."""
    return ", ".join(_words(entry.detail))


def _words(detail: Mapping[str, Any]) -> Iterator[str]:
    for one in SURROUNDINGS:
        if one.key in detail:
            yield f"{one.label} {detail[one.key]:g} {one.unit}"
    if instrument := detail.get(_INSTRUMENT):
        yield f"instrument {instrument}"
    if remark := detail.get(_REMARK):
        yield str(remark)
