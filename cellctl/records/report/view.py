"""What the report shows, worked out from the record; the template only places it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from cellctl.force.contact.curve import ForceCurve, curve_statistics
from cellctl.records.entries import Calibration, Iteration, RunRecord, RunResult
from cellctl.records.plots import (
    errors_by_iteration,
    force_by_time,
    force_by_travel,
    plug_gauges,
)
from cellctl.records.plots.gauge import HOLE_MM, LEAST_MM
from cellctl.records.report.calibration_view import (
    CalibrationLine,
    HeadLine,
    PoseLine,
    calibration_lines,
    head_lines,
    pose_lines,
)
from cellctl.records.report.hole_view import (
    MeasurementView,
    PictureGroup,
    measurement_view,
    picture_groups,
)
from cellctl.records.report.text import facts, fixed, number

COMPONENTS = ("X", "Y", "Z", "rx", "ry", "rz")
_VERDICTS = {
    RunResult.GOOD: ("Good part", "good"),
    RunResult.BAD: ("Bad part", "bad"),
    RunResult.STOPPED: ("Stopped", "bad"),
    RunResult.ABORTED: ("Aborted", "bad"),
    RunResult.INTERRUPTED: ("Interrupted", "bad"),
}


@dataclass(frozen=True, slots=True)
class Tile:
    """One headline figure with its bound."""

    title: str
    value: str
    bound: str
    passed: bool | None
    """None where there is nothing to judge."""


@dataclass(frozen=True, slots=True)
class ForceSection:
    """One recorded approach."""

    title: str
    by_time: str
    by_travel: str
    facts: tuple[tuple[str, str], ...]
    complete: bool


@dataclass(frozen=True, slots=True)
class ReportView:
    """Everything that the template needs."""

    record: RunRecord
    verdict: str
    verdict_class: str
    tiles: tuple[Tile, ...]
    calibrations: tuple[CalibrationLine, ...]
    heads: tuple[HeadLine, ...]
    poses: tuple[PoseLine, ...]
    measurements: tuple[MeasurementView, ...]
    pictures: tuple[PictureGroup, ...]
    iterations_svg: str
    forces: tuple[ForceSection, ...]
    mating: tuple[tuple[str, str], ...]
    gauges_svg: str
    gauge_rows: tuple[tuple[str, str, str, str, bool], ...]
    """Hole, gauge, offset, source, whether it passed."""


def build_view(
    record: RunRecord,
    calibrations: Mapping[str, Calibration],
    curves: Mapping[str, tuple[ForceCurve, bool]],
    addresses: Mapping[str, str],
) -> ReportView:
    """``calibrations`` by id, ``curves`` by the name of their file, ``addresses`` of pictures."""
    result = record.head.result
    verdict, verdict_class = (
        ("Not closed", "bad") if result is None else _VERDICTS[RunResult(result)]
    )
    used = [calibrations[i] for i in record.head.calibration_ids.values() if i in calibrations]
    mating = record.mating or {}
    return ReportView(
        record=record,
        verdict=verdict,
        verdict_class=verdict_class,
        tiles=_tiles(record, curves),
        calibrations=tuple(calibration_lines(record.head.calibration_ids, calibrations)),
        heads=tuple(head_lines(used)),
        poses=tuple(pose_lines(used)),
        measurements=tuple(measurement_view(entry) for entry in record.measurements),
        pictures=picture_groups(addresses),
        iterations_svg=errors_by_iteration(record.iterations) if record.iterations else "",
        forces=tuple(_force(name, *entry, record) for name, entry in curves.items()),
        mating=tuple(facts(mating)),
        gauges_svg=plug_gauges(record.gauges) if record.gauges else "",
        gauge_rows=tuple(
            (
                gauge.hole,
                fixed(gauge.diameter_mm, 2),
                fixed(HOLE_MM - gauge.diameter_mm, 2),
                gauge.source,
                gauge.diameter_mm >= LEAST_MM,
            )
            for gauge in record.gauges
        ),
    )


def worst_share(iteration: Iteration) -> float:
    """The greatest error of an iteration as a share of its threshold."""
    pairs = zip(iteration.error_mm_deg, iteration.threshold_mm_deg, strict=True)
    return max(abs(error or 0.0) / (threshold or 1.0) for error, threshold in pairs)


def _tiles(record: RunRecord, curves: Mapping[str, tuple[ForceCurve, bool]]) -> tuple[Tile, ...]:
    tiles = []
    if record.iterations:
        last = record.iterations[-1]
        errors, thresholds = last.error_mm_deg, last.threshold_mm_deg
        for title, part, unit, decimals in (
            ("Position error", slice(0, 3), "mm", 4),
            ("Angle error", slice(3, 6), "°", 5),
        ):
            worst = max(abs(error or 0.0) for error in errors[part])
            bound = max(value or 0.0 for value in thresholds[part])
            text = f"worst axis, threshold {number(bound)} {unit}"
            tiles.append(Tile(title, f"{worst:.{decimals}f} {unit}", text, worst <= bound))
        count = len(record.iterations)
        tiles.append(
            Tile(
                "Loop measurements",
                str(count),
                "last one within" if last.converged else "not within",
                last.converged,
            )
        )
    limit_n = _figure(record.mating, "limit_force_n")
    peaks = [float(curve.wrench[:, 2].max()) for curve, _ in curves.values() if len(curve.time_s)]
    if peaks:
        allowed = f"sensed, limit {limit_n:g} N" if limit_n else "sensed"
        passed = max(peaks) < limit_n if limit_n else None
        tiles.append(Tile("Peak force", f"{max(peaks):.1f} N", allowed, passed))
    if record.gauges:
        least = min(gauge.diameter_mm for gauge in record.gauges)
        allowed = f"of {HOLE_MM:.2f}, at least {LEAST_MM:.2f}"
        tiles.append(Tile("Least plug gauge", f"{least:.2f} mm", allowed, least >= LEAST_MM))
    return tuple(tiles)


def _figure(mating: Mapping[str, object] | None, key: str) -> float | None:
    value = (mating or {}).get(key)
    return float(value) if isinstance(value, int | float) else None


def _force(name: str, curve: ForceCurve, complete: bool, record: RunRecord) -> ForceSection:  # noqa: FBT001
    target_n = _figure(record.mating, "target_force_n")
    limit_n = _figure(record.mating, "limit_force_n")
    travelled = bool(len(curve.travel_m)) and bool((curve.travel_m == curve.travel_m).any())
    return ForceSection(
        title=PurePosixPath(name).stem.replace("-", " ").replace("_", " "),
        by_time=force_by_time(curve, target_n, limit_n),
        by_travel=force_by_travel(curve, target_n, limit_n) if travelled else "",
        facts=tuple(_statistics(curve)),
        complete=complete,
    )


def _statistics(curve: ForceCurve) -> Sequence[tuple[str, str]]:
    if len(curve.time_s) < 2:
        return [("samples", str(len(curve.time_s)))]
    figures = curve_statistics(curve.time_s, curve.wrench)
    return [
        ("samples", f"{figures.samples} at {figures.rate_hz:.0f} Hz"),
        ("duration", f"{figures.duration_s:.2f} s"),
        ("peak Fz, every sample", f"{figures.peak_fz_n:.2f} N"),
        ("peak Fz, mean of 5 ms", f"{figures.peak_filtered_fz_n:.2f} N"),
        ("peak lateral force", f"{figures.peak_lateral_n:.2f} N"),
        ("peak moment", f"{figures.peak_moment_n_m:.2f} N·m"),
        ("final Fz", f"{figures.final[2]:.2f} ± {figures.final_sigma[2]:.2f} N"),
    ]
