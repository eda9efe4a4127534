"""Pin holes of an assembly with the gauge that counts, its limits and the one verdict on it."""

from dataclasses import dataclass

from cellctl.records.entered.gauges import bores_mm, gauge_limits, judge_gauge
from cellctl.records.entries import Gauge, RunRecord, Verdict
from cellctl.records.figures import Limit

_BORE_MM = 6.0
"""Pin hole of both parts of the paper, for runs of earlier versions, which do not name theirs."""
_PAPER = Limit(5.80, _BORE_MM)
"""Its acceptance, an offset of less than 0.2 mm; such runs are shown beside it and not judged."""


@dataclass(frozen=True, slots=True)
class GaugedHole:
    """A pin hole that a person has gauged."""

    gauge: Gauge
    bore_mm: float
    """Drawn diameter."""
    least_mm: float
    most_mm: float
    """What the gauge may be."""
    verdict: Verdict | None
    """None where the run does not say what its gauges may be."""

    @property
    def failed(self) -> bool:
        """Whether the gauge makes the part a bad one."""
        return self.verdict is Verdict.FAIL

    @property
    def offset_below_mm(self) -> float | None:
        """Upper bound of the offset between deck and frame, mm.

        None for a gauge that is wider than the drawn bore: it shows that the bore is wide, and
        nothing about the offset.
        """
        below_mm = self.bore_mm - self.gauge.diameter_mm
        return below_mm if below_mm >= 0.0 else None


def gauged_holes(record: RunRecord) -> tuple[GaugedHole, ...]:
    """Every hole that was gauged, with the newest gauge."""
    limits, bores = gauge_limits(record), bores_mm(record)
    return tuple(
        _gauged(record, gauge, limits.get(gauge.hole, _PAPER), bores.get(gauge.hole, _BORE_MM))
        for gauge in record.gauges
    )


def _gauged(record: RunRecord, gauge: Gauge, limit: Limit, bore_mm: float) -> GaugedHole:
    least_mm = bore_mm if limit.lower is None else limit.lower
    most_mm = bore_mm if limit.upper is None else limit.upper
    return GaugedHole(gauge, bore_mm, least_mm, most_mm, judge_gauge(record, gauge))
