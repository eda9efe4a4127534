"""Plug gauges: which holes of a run may be gauged, and what a gauge says about the part.

A process records the document ``GAUGE_HOLES`` in each run whose part can be gauged:
``{"P1": {"least_mm": 5.8, "most_mm": 6.0}, …}``, where ``most_mm`` is the drawn bore. Runs of
earlier versions have none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from cellctl.errors.records.store import GaugeRefused, ValueRefused
from cellctl.records.entered.said_by import gauge_entries, measured_by
from cellctl.records.entries import DRY_RUN, AuditEntry, Gauge, RunRecord, RunResult, Verdict
from cellctl.records.figures import NO_LIMIT, Limit
from cellctl.records.required.required_figures import not_measured

GAUGE_HOLES = "gauge_holes"
PART_VERDICT = "part_verdict"
"""Key of the verdict on the part wherever programs are told of a run."""
_RANGE_MM = Limit(0.5, 50.0)
"""Diameters that plug gauges for pin holes have; anything else is a slip of the keyboard."""
_WIDER_BORE_MM = 0.05
"""How much wider than drawn a bore for a pin may be made; no wider gauge passes it."""
_NO_PART = frozenset({RunResult.STOPPED, RunResult.ABORTED, RunResult.INTERRUPTED})


def gauge_limits(record: RunRecord) -> Mapping[str, Limit]:
    """Limits of the gauge of each hole, mm; empty when the run does not say."""
    return hole_limits(record.document(GAUGE_HOLES))


def hole_limits(holes: Mapping[str, Mapping[str, float]]) -> Mapping[str, Limit]:
    """Limits of the gauge of each hole, mm, from the document ``GAUGE_HOLES``."""
    return {
        # Rounded as gauges are: the sum must not come out a rounding error below the widest one.
        name: Limit(hole["least_mm"], round(hole["most_mm"] + _WIDER_BORE_MM, 3))
        for name, hole in holes.items()
    }


def bores_mm(record: RunRecord) -> Mapping[str, float]:
    """Drawn diameter of each hole, mm; empty when the run does not say."""
    return {name: hole["most_mm"] for name, hole in record.document(GAUGE_HOLES).items()}


def beyond_limit(limits: Mapping[str, Limit], newest_mm: Mapping[str, float]) -> bool:
    """Whether the newest gauge of some hole fails; a hole without a limit has none to fail."""
    verdicts = (limits.get(hole, NO_LIMIT).judge(mm) for hole, mm in newest_mm.items())
    return Verdict.FAIL in verdicts


def judge_gauge(record: RunRecord, gauge: Gauge) -> Verdict | None:
    """Whether a gauge is within the limits of its hole; None when the run does not say."""
    return gauge_limits(record).get(gauge.hole, NO_LIMIT).judge(gauge.diameter_mm)


def part_verdict(record: RunRecord) -> str | None:
    """Verdict on the part with its plug gauges, which can turn a good part into a bad one.

    The result of the run itself never changes: it says how the run ended.
    """
    # Only the newest gauge of each hole: an earlier one may have been a mistake of whoever entered
    # it.
    newest_mm = {gauge.hole: gauge.diameter_mm for gauge in record.gauges}
    spoilt = beyond_limit(gauge_limits(record), newest_mm)
    return with_gauges(record.head.result, spoilt=spoilt)


def with_gauges(result: str | None, *, spoilt: bool) -> str | None:
    """Verdict on the part of a run with this result; ``spoilt``: a gauge is beyond its limit."""
    return RunResult.BAD if result == RunResult.GOOD and spoilt else result


def for_programs(record: RunRecord, audit: Sequence[AuditEntry]) -> dict[str, Any]:
    """What programs are told beside the record: ``part_verdict``, the required figures that the run
    has ended without (``not_measured``), and each gauge with its verdict
    and who measured and typed it; ``audit`` is the whole log."""
    entries = gauge_entries(record.head.number, audit)

    def told(gauge: Gauge) -> dict[str, Any]:
        verdict, who = judge_gauge(record, gauge), measured_by(gauge, entries)
        return asdict(gauge) | {"verdict": verdict, "measured_by": who}

    return {
        PART_VERDICT: part_verdict(record),
        "not_measured": [
            {name: getattr(one, name) for name in ("key", "label", "unit", "lower", "upper")}
            for one in not_measured(record)
        ],
        "gauges": [told(gauge) for gauge in record.gauges],
        "gauge_history": [told(gauge) for gauge in record.gauge_history],
    }


def require_plausible(hole: str, diameter_mm: float, source: str) -> None:
    """Raise ``ValueRefused`` for what is no result of a plug gauge."""
    if _RANGE_MM.judge(diameter_mm) is not Verdict.PASS:
        allowed = f"allowed {_RANGE_MM.lower:g} to {_RANGE_MM.upper:g}"
        raise ValueRefused(f"plug gauge {diameter_mm:g} mm, {allowed}")
    if not hole or not source:
        raise ValueRefused("a gauge result needs its hole and who measured it")


def require_gauge(record: RunRecord, hole: str, diameter_mm: float) -> None:
    """Raise ``GaugeRefused`` for a result that cannot be of this run."""
    head = record.head
    if head.result is None:
        # Not closed by a daemon that was killed either: the next start does that, as interrupted.
        raise GaugeRefused(
            f"run {head.number} is not closed: a daemon is at work on it, or was killed and closes "
            "it when it is started again"
        )
    if head.result in _NO_PART:
        raise GaugeRefused(f"run {head.number} is {head.result}: it has no finished part")
    if head.mode == DRY_RUN:
        raise GaugeRefused(f"run {head.number} is a dry run: its part was never joined")
    known = record.document(GAUGE_HOLES)
    # Runs of earlier versions do not name their holes: any hole is taken then.
    if known and hole not in known:
        raise GaugeRefused(f"run {head.number} has no pin hole {hole}; it has {', '.join(known)}")
    widest_mm = gauge_limits(record).get(hole, NO_LIMIT).upper
    # Not of the mating, whatever that was like: the gauge would not have entered the bore.
    if widest_mm is not None and diameter_mm > widest_mm:
        raise GaugeRefused(
            f"plug gauge {diameter_mm:g} mm in hole {hole} of run {head.number}, whose bore is "
            f"drawn as {bores_mm(record)[hole]:g} mm; allowed up to {widest_mm:g} mm: check the "
            "figure that was typed, and which hole was gauged"
        )
