"""The headline figures of an assembly."""

from collections.abc import Iterable, Iterator, Sequence

from cellctl.processes.deck_to_frame.record.keys import LIMIT_FORCE
from cellctl.processes.deck_to_frame.report.gauge_plot import HOLE_MM, LEAST_MM
from cellctl.records.curve_file import Recording
from cellctl.records.entries import Gauge, LoopPass, RunRecord
from cellctl.records.report.sections import Tile
from cellctl.records.report.text import decimals, number


def tiles(record: RunRecord, curves: Iterable[Recording]) -> tuple[Tile, ...]:
    """The headline figures that the record of this run can fill."""
    return (
        *_errors(record.passes),
        *_peak_force(curves, record.value(LIMIT_FORCE)),
        *_least_gauge(record.gauges),
    )


def _errors(passes: Sequence[LoopPass]) -> Iterator[Tile]:
    if not passes:
        return
    last = passes[-1]
    for title, part in (("Position error", slice(0, 3)), ("Angle error", slice(3, 6))):
        components = last.components[part]
        unit = components[0].unit
        worst = max(abs(component.value or 0.0) for component in components)
        bound = max(component.limit or 0.0 for component in components)
        text = f"worst axis, threshold {number(bound)} {unit}"
        yield Tile(title, f"{worst:.{decimals(unit)}f} {unit}", text, worst <= bound)
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


def _least_gauge(gauges: Sequence[Gauge]) -> Iterator[Tile]:
    if gauges:
        least = min(gauge.diameter_mm for gauge in gauges)
        allowed = f"of {HOLE_MM:.2f}, at least {LEAST_MM:.2f}"
        yield Tile("Least plug gauge", f"{least:.2f} mm", allowed, least >= LEAST_MM)
