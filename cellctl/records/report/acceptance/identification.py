"""What an acceptance record is about: which parts, made by whom, on which order, in which
surroundings."""

from collections.abc import Iterator, Sequence

from cellctl.packml.unit_command import Source
from cellctl.records.entered.notes import SURROUNDINGS, remark_of, surroundings
from cellctl.records.entered.said_by import ORDER, said_by, was_obeyed
from cellctl.records.entries import MAINTENANCE, AuditEntry, RunHead
from cellctl.records.report.acceptance.runs_before import RunBefore, words_of_runs_before
from cellctl.records.report.sections import FactList, Part, ReportSection
from cellctl.records.report.text import duration, number, when, with_unit

UNKNOWN = "not recorded"
_GIVEN_BY = {
    Source.TERMINAL: "at the terminal `cellctl start --order ORDER` gives it",
    Source.LINE: "the line gives it in its register order, holding 18 to 25",
    Source.PAGE: "the operator page asks for none; key order of its HTTP API gives it",
}
"""How an order comes with a Start, by the source of that."""
SIGNATURES = ("performed by", "inspected by", "accepted by")
"""Who signs a report by hand."""


def identification(
    head: RunHead,
    parts: Sequence[Part],
    audit: Sequence[AuditEntry],
    notes: Sequence[AuditEntry],
    before: Sequence[RunBefore],
) -> ReportSection:
    """Parts, order, people, recipe and surroundings; what nobody has recorded says so.

    ``audit`` is that of the run's time, ``notes`` are those on the run, ``before`` are earlier runs
    of its part.
    """
    named = parts or (Part("part", head.serial),)
    starts = (one for one in audit if one.action == "start" and was_obeyed(one))
    start = next(starts, None)
    facts = (
        *((f"serial number, {part.role}", part.serial or UNKNOWN) for part in named),
        ("order, as given with Start", _order(head, start)),
        ("started by", UNKNOWN if start is None else start.actor),
        ("run", str(head.number)),
        ("process", head.process),
        ("recipe", f"{head.recipe_id} · {head.recipe_name}"),
        ("mode", head.mode),
        ("started", when(head.started)),
        ("ended", when(head.ended)),
        ("duration", duration(head.started, head.ended)),
        ("devices", "simulated" if head.simulated else "real"),
        ("software", head.software),
        *_surroundings(notes),
        *(("this part before", said) for said in words_of_runs_before(before)),
        *_remarks(notes),
    )
    return ReportSection("Identification", (FactList(facts),))


def _order(head: RunHead, start: AuditEntry | None) -> str:
    """The order that was given with the Start of a run; where none was, how one is given."""
    if start is None:
        return head.operator or UNKNOWN
    given = start.detail.get(ORDER)
    if not given and head.operator != start.actor:
        # A Start without an order leaves its person in this place, who has a line of their own.
        given = head.operator
    if given:
        return str(given)
    if MAINTENANCE in (head.process, head.mode):
        return "none: procedures have none"
    how = [words for source, words in _GIVEN_BY.items() if start.actor.startswith(source)]
    return "; ".join(("none was given", *how))


def _surroundings(notes: Sequence[AuditEntry]) -> Iterator[tuple[str, str]]:
    """Each known quantity with who read it and from what; the others in one line."""
    known = surroundings(notes)
    for found in known.values():
        source = ", ".join(filter(None, (said_by(found.entry), found.instrument)))
        value = with_unit(number(found.value), found.surrounding.unit)
        yield found.surrounding.label, f"{value} ({source})"
    missing = [one.label for one in SURROUNDINGS if one.key not in known]
    if missing:
        yield ", ".join(missing), UNKNOWN


def _remarks(notes: Sequence[AuditEntry]) -> Iterator[tuple[str, str]]:
    """What people had to say of the run, above the signatures and not only in the timeline."""
    for entry in notes:
        if said := remark_of(entry):
            yield "remark", f"{said} ({said_by(entry)}, {when(entry.time)})"
