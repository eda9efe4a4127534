"""A requirement on a part or on its making, beside what was found."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace

from cellctl.records.entries import DRY_RUN, Figure, RunRecord, RunResult, Verdict
from cellctl.records.figures import NO_LIMIT, Limit
from cellctl.records.required.required_figures import not_measured, states_required
from cellctl.records.units import scaled, unit_on_pages


@dataclass(frozen=True, slots=True)
class Requirement:
    """One line of the acceptance table."""

    title: str
    value: float | None
    """What was measured; None is unknown."""
    unit: str
    required: Limit
    """The limit, as the recipe or the drawing states it."""
    verdict: Verdict | None
    """The verdict; None where nothing need be measured. FAIL without a value: not measured."""
    expanded: float | None = None
    """Expanded uncertainty of the value (JCGM 100, 6.2) with ``COVERAGE_FACTOR``; None where none
    was evaluated, and the value is judged by its limit alone."""
    accepted: Limit = NO_LIMIT
    """The limit less the expanded uncertainty, where that decides (JCGM 106, 8.3)."""
    threshold: bool = False
    """Whether the limit only ends a correction: the value as measured is compared with it, and
    nothing is decided about the part."""
    phase: int | None = None
    """Number of the phase in which the value was found."""
    figure: str = ""
    """Key of the figure that it shows, so that it is not shown twice."""
    stands_for: str = ""
    """Key of a figure with a limit that is the worst of this and further lines."""


@dataclass(frozen=True, slots=True)
class RequirementGroup:
    """Requirements of one kind; ``note`` names their reference frame or how they were found."""

    title: str
    requirements: tuple[Requirement, ...]
    note: str = ""


def of_figure(
    record: RunRecord, key: str, title: str = "", *, expanded: float | None = None
) -> Requirement | None:
    """The last figure of a key as a requirement; None when the run has none with a limit."""
    found = record.newest_figures.get(key)
    if found is None or found.verdict is None:
        return None
    return Requirement(
        title=title or found.label,
        value=found.value,
        unit=found.unit,
        required=Limit(found.lower, found.upper),
        verdict=found.verdict,
        expanded=expanded,
        phase=found.phase,
        figure=key,
    )


def guarded(record: RunRecord, key: str, title: str, expanded: float | None) -> Requirement | None:
    """A figure that was judged by its limit less its expanded uncertainty.

    The record keeps the narrower limit, by which the verdict was reached; the required one is wider
    by the uncertainty on both sides.
    """
    plain = of_figure(record, key, title, expanded=expanded)
    if plain is None or expanded is None:
        return plain
    narrow = plain.required
    lower = None if narrow.lower is None else narrow.lower - expanded
    upper = None if narrow.upper is None else narrow.upper + expanded
    return replace(plain, required=Limit(lower, upper), accepted=narrow)


def on_page(entry: Requirement) -> Requirement:
    """The same in the unit of pages, uncertainty and limits with the value."""
    unit, factor = unit_on_pages(entry.unit)

    def times(limit: Limit) -> Limit:
        return Limit(scaled(limit.lower, factor), scaled(limit.upper, factor))

    return replace(
        entry,
        unit=unit,
        value=scaled(entry.value, factor),
        expanded=scaled(entry.expanded, factor),
        required=times(entry.required),
        accepted=times(entry.accepted),
    )


def of_figures(record: RunRecord, titles: Mapping[str, str]) -> Iterator[Requirement]:
    """Those of the titled keys, in their order, of which the run has a figure with a limit."""
    for key, title in titles.items():
        found = of_figure(record, key, title)
        if found is not None:
            yield found


def missing(entry: Figure, title: str = "", *, threshold: bool = False) -> Requirement:
    """A requirement that nothing was measured for, with its limit."""
    return Requirement(
        title or entry.label,
        None,
        entry.unit,
        Limit(entry.lower, entry.upper),
        Verdict.FAIL,
        threshold=threshold,
        figure=entry.key,
    )


def unmeasured(
    record: RunRecord, titles: Mapping[str, str], always: Collection[str] | None = None
) -> Iterator[Requirement]:
    """What a run that was to make a part has ended without, by the keys of its figures.

    A report that left these lines out would show nothing but green ones of a run that was cut off
    before its verification. One that is open may measure it yet. Runs of earlier versions do not
    say what they require: of them it is what every run measures that comes to its end, ``always``
    of the titles where not all.
    """
    if states_required(record):
        lacking = {one.key: one for one in not_measured(record)}
        yield from (missing(lacking[key], titles[key]) for key in titles if key in lacking)
        return
    if record.head.mode == DRY_RUN or record.head.result in (None, RunResult.GOOD):
        return
    for key, title in titles.items():
        if always is not None and key not in always:
            continue
        nested = f"{key}."
        if not any(one == key or one.startswith(nested) for one in record.newest_figures):
            yield Requirement(title, None, "", NO_LIMIT, Verdict.FAIL, figure=key)
