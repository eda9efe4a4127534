"""Whether a process keeps more and more: slopes with their confidence, against bounds.

One value a cycle, always read at the same point of it, when the line has its result and the cell
waits: within a cycle memory rises and falls by images. The slope is that of Theil and Sen, the
median of all pairs, with the confidence interval of Kendall's statistic (P. K. Sen, 1968). It asks
for no normal distribution, and one step, such as a pool that was filled, is not a trend.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.stats import theilslopes

from tests.rigs.kept import Kept

CONFIDENCE = 0.95
WARM_UP = 0.2
"""Share of the cycles that is not judged: caches, pools and lazily loaded modules fill then."""
WARM_UP_LEAST = 2
LEAST = 5
"""Judged cycles without which nothing is said."""
BOUNDS: Mapping[str, float] = {"memory_kb": 20_000.0, "descriptors": 2.0, "threads": 1.0}
"""Most that may be kept in an hour. At 20 MB an hour a PC with 8 GB works for two weeks."""


class Verdict(StrEnum):
    """What the slope and its interval say of a bound."""

    FLAT = "flat"
    """Surely below it."""
    UNDECIDED = "undecided"
    """More cycles would tell."""
    GROWS = "GROWS"
    """Surely above it."""


@dataclass(frozen=True, slots=True)
class Looked:
    """What one process kept after each cycle."""

    process: str
    time_s: Sequence[float]
    """Times since the start, one for each cycle, rising."""
    kept: Sequence[Kept]


@dataclass(frozen=True, slots=True)
class Trend:
    """One quantity of one process, per hour."""

    process: str
    quantity: str
    """A field of ``Kept``."""
    first: float
    """Median of the first third of what is judged."""
    last: float
    """Median of the last third."""
    slope: float
    low: float
    high: float
    bound: float

    @property
    def verdict(self) -> Verdict:
        """Judge by the whole interval, so that too few cycles are no proof."""
        if self.high <= self.bound:
            return Verdict.FLAT
        return Verdict.GROWS if self.low > self.bound else Verdict.UNDECIDED


def judged_from(cycles: int) -> int:
    """Index of the first cycle that is judged."""
    return max(WARM_UP_LEAST, round(WARM_UP * cycles))


def trends(looked: Looked, bounds: Mapping[str, float] = BOUNDS) -> list[Trend]:
    """Trend of each bounded quantity; raises ``ValueError`` for too few cycles."""
    begin = judged_from(len(looked.kept))
    hours = np.array(looked.time_s[begin:], dtype=float) / 3600.0
    if len(hours) < LEAST:
        raise ValueError(
            f"{looked.process}: {len(looked.kept)} cycles are too few, {begin} warm up and "
            f"{LEAST} are judged"
        )
    third = max(1, len(hours) // 3)
    found = []
    for quantity, bound in bounds.items():
        values = np.array([getattr(one, quantity) for one in looked.kept[begin:]], dtype=float)
        slope, _, low, high = theilslopes(values, hours, CONFIDENCE)
        ends = float(np.median(values[:third])), float(np.median(values[-third:]))
        found.append(
            Trend(looked.process, quantity, *ends, float(slope), float(low), float(high), bound)
        )
    return found
