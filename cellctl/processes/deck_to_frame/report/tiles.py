"""The headline figures of an assembly."""

from collections.abc import Iterable, Iterator, Sequence

from cellctl.processes.deck_to_frame.record.keys import (
    GAP_BY_VISION,
    LIMIT_FORCE,
    PIN_OFFSETS,
    SEAT_ROTATION,
)
from cellctl.processes.deck_to_frame.record.worst_component import worst_component
from cellctl.processes.deck_to_frame.report.gauged_holes import GaugedHole, gauged_holes
from cellctl.records.entries import Figure, LoopPass, RunRecord, Verdict
from cellctl.records.figures import Limit
from cellctl.records.files.curve_file import Recording
from cellctl.records.report.sections import Tile
from cellctl.records.report.text import decimals, fixed, quantity, with_unit


def tiles(record: RunRecord, curves: Iterable[Recording]) -> tuple[Tile, ...]:
    """The headline figures that the record of this run can fill: of the seat, once it has one."""
    return (
        *(tuple(_seat(record)) or _errors(record.passes)),
        *_peak_force(curves, record.value(LIMIT_FORCE)),
        *_gauge(gauged_holes(record)),
    )


def _seat(record: RunRecord) -> Iterator[Tile]:
    prefix = f"{PIN_OFFSETS}."
    figures = record.newest_figures
    offsets = [found for key, found in figures.items() if key.startswith(prefix)]
    if offsets:
        worst = max(offsets, key=lambda found: found.value or 0.0)
        yield _seat_tile("Seated: greatest offset", worst)
    for key, title in ((GAP_BY_VISION, "Seated: gap"), (SEAT_ROTATION, "Seated: rotation")):
        if key in figures:
            yield _seat_tile(title, figures[key])


def _seat_tile(title: str, found: Figure) -> Tile:
    value = with_unit(fixed(found.value, decimals(found.unit)), found.unit)
    # The record keeps the required limit less the uncertainty, by which the seat was judged.
    bound = f"accepted up to {with_unit(fixed(found.upper, decimals(found.unit)), found.unit)}"
    return Tile(title, value, bound, found.verdict is Verdict.PASS)


def _errors(passes: Sequence[LoopPass]) -> Iterator[Tile]:
    if not passes:
        return
    last = passes[-1]
    for title, part in (("Position error", slice(0, 3)), ("Angle error", slice(3, 6))):
        worst = worst_component(last.components[part])
        size = None if worst.value is None else abs(worst.value)
        value = with_unit(fixed(size, decimals(worst.unit)), worst.unit)
        text = f"{worst.name}, threshold {quantity(worst.limit, worst.unit)}"
        verdict = Limit(upper=worst.limit).judge(size)
        yield Tile(title, value, text, verdict is Verdict.PASS)
    ended = "last one within" if last.converged else "not within"
    yield Tile("Loop measurements", str(len(passes)), ended, last.converged)


def _peak_force(curves: Iterable[Recording], limit_n: float | None) -> Iterator[Tile]:
    peaks = [
        float(recording.curve.wrench[:, 2].max())
        for recording in curves
        if len(recording.curve.time_s)
    ]
    if peaks:
        allowed = f"sensed, limit {limit_n:g} N" if limit_n else "sensed"
        passed = max(peaks) < limit_n if limit_n else None
        yield Tile("Peak force", f"{max(peaks):.1f} N", allowed, passed)


def _gauge(holes: Sequence[GaugedHole]) -> Iterator[Tile]:
    """Of the gauge that fails, or of the least one."""
    if holes:
        worst = min(holes, key=lambda hole: (not hole.failed, hole.gauge.diameter_mm))
        diameter_mm = worst.gauge.diameter_mm
        title = f"Plug gauge {worst.gauge.hole}" if worst.failed else "Least plug gauge"
        wide = diameter_mm > worst.most_mm
        bound = f"at most {worst.most_mm:.2f}" if wide else f"at least {worst.least_mm:.2f}"
        passed = None if worst.verdict is None else not worst.failed
        yield Tile(title, f"{diameter_mm:.2f} mm", f"of {worst.bore_mm:.2f}, {bound}", passed)
