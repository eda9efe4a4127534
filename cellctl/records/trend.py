"""One figure over many runs: how capable the process is, and whether it drifts.

Sources: D. Montgomery, *Introduction to Statistical Quality Control*, chapters 6.4 (control charts
for individuals) and 8.3 (capability and its confidence intervals, Bissell's for Cpk).
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from statistics import NormalDist, fmean

_D2 = 1.128
"""Mean range of two values of a normal distribution, in standard deviations."""
_RANGE_EFFICIENCY = 0.62
"""Degrees of freedom of a sigma from moving ranges of two, per value."""
_LEAST = 10
"""Fewer runs say nothing of a spread: their interval would span a factor of three."""
_ONE_SIDE, _RISING = 8, 6
"""Length of a row of values on one side of the mean, and of one that rises or falls, that is a
signal."""
CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True)
class Sample:
    """A figure of one run, with the limits that it was judged by."""

    run: int
    time: datetime
    value: float
    lower: float | None
    upper: float | None


@dataclass(frozen=True, slots=True)
class Index:
    """A capability index with its interval at the ``CONFIDENCE`` level, both sides."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Signal:
    """A run in which the control chart says that something has changed."""

    run: int
    rule: str


@dataclass(frozen=True, slots=True)
class Trend:
    """What the runs say together; ``sigma`` is that from run to run, without a drift."""

    count: int
    mean: float
    sigma: float
    lower_control: float
    upper_control: float
    cp: Index | None
    """Potential capability; None without two limits, or with too few runs."""
    cpk: Index | None
    """Capability with the mean where it is; None without a limit, or with too few runs."""
    signals: tuple[Signal, ...]


def trend(samples: Sequence[Sample]) -> Trend:
    """Samples in their order in time; two at least, else ``ValueError``.

    The limits are those of the newest run: they say what the process has to keep from now on.
    """
    if len(samples) < 2:
        raise ValueError(f"{len(samples)} runs have this figure; a trend needs two")
    values = [sample.value for sample in samples]
    mean = fmean(values)
    ranges = [abs(b - a) for a, b in itertools.pairwise(values)]
    # Not the standard deviation of all values: a slow drift would widen that, and so hide itself.
    sigma = fmean(ranges) / _D2
    newest = samples[-1]
    enough = len(samples) >= _LEAST and sigma > 0
    return Trend(
        count=len(samples),
        mean=mean,
        sigma=sigma,
        lower_control=mean - 3 * sigma,
        upper_control=mean + 3 * sigma,
        cp=_cp(newest, sigma, len(samples)) if enough else None,
        cpk=_cpk(newest, mean, sigma, len(samples)) if enough else None,
        signals=tuple(_signals(samples, mean, sigma)),
    )


def _freedom(count: int) -> float:
    return max(1.0, _RANGE_EFFICIENCY * (count - 1))


def _cp(newest: Sample, sigma: float, count: int) -> Index | None:
    if newest.lower is None or newest.upper is None:
        return None
    value = (newest.upper - newest.lower) / (6 * sigma)
    low, high = (math.sqrt(share) for share in _chi_square_shares(_freedom(count)))
    return Index(value, value * low, value * high)


def _cpk(newest: Sample, mean: float, sigma: float, count: int) -> Index | None:
    room = []
    if newest.upper is not None:
        room.append(newest.upper - mean)
    if newest.lower is not None:
        room.append(mean - newest.lower)
    if not room:
        return None
    value = min(room) / (3 * sigma)
    # Bissell 1990: the mean is as uncertain as the spread.
    spread = math.sqrt(1 / (9 * count) + value**2 / (2 * _freedom(count)))
    z = NormalDist().inv_cdf(0.5 + CONFIDENCE / 2)
    return Index(value, value - z * spread, value + z * spread)


def _chi_square_shares(freedom: float) -> tuple[float, float]:
    """Quantiles of chi square over its degrees of freedom: Wilson and Hilferty's approximation.

    Within 3 % of the exact ones from six degrees of freedom on, and without loading scipy.
    """
    part = 2 / (9 * freedom)
    z = NormalDist().inv_cdf(0.5 + CONFIDENCE / 2)
    low, high = ((1 - part + sign * z * math.sqrt(part)) ** 3 for sign in (-1, 1))
    return low, high


def _signals(samples: Sequence[Sample], mean: float, sigma: float) -> Iterator[Signal]:
    """Far out, long on one side, steadily moving: rules 1 to 3 of Nelson (1984).

    The second with the eight in a row of the Western Electric rules, where Nelson has nine.
    """
    side, moving = 0, 0
    before: float | None = None
    for sample in samples:
        off = sample.value - mean
        if sigma > 0 and abs(off) > 3 * sigma:
            yield Signal(sample.run, f"{abs(off) / sigma:.1f} sigma from the mean")
        side = _counted(side, off)
        if abs(side) == _ONE_SIDE:
            yield Signal(sample.run, f"{_ONE_SIDE} runs on one side of the mean")
        # Six values that rise have five steps between them.
        moving = 0 if before is None else _counted(moving, sample.value - before)
        if abs(moving) == _RISING - 1:
            direction = "rising" if moving > 0 else "falling"
            yield Signal(sample.run, f"{_RISING} runs {direction} one after the other")
        before = sample.value


def _counted(count: int, change: float) -> int:
    """How often in a row a change had this sign; negative for falling."""
    if change == 0:
        return 0
    step = 1 if change > 0 else -1
    return count + step if count * step > 0 else step
