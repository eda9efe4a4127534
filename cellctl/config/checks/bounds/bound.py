"""One figure of a cell file, and what it must keep."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from cellctl.config.issue import ConfigIssue, WrittenValue

_SAME = 1e-9
"""Share by which a figure may miss its limit: what was written as the limit is kept."""


@dataclass(frozen=True, slots=True)
class Bound:
    """Least and greatest value of a figure, with the reason."""

    key: str
    value: float
    why: str
    least: float | None = None
    most: float | None = None
    against: tuple[WrittenValue, ...] = ()
    """What the limit follows from and is no figure, such as a taught pose."""

    @property
    def missing(self) -> float:
        """By how much the value misses its limits; zero or less where it keeps them."""
        low = -math.inf if self.least is None else self.least - self.value
        high = -math.inf if self.most is None else self.value - self.most
        return max(low, high)

    @property
    def is_low(self) -> bool:
        """Whether the value misses the least, not the greatest."""
        return self.least is not None and self.value < self.least

    @property
    def is_broken(self) -> bool:
        """Whether the value is outside of its limits."""
        limit = self.least if self.is_low else self.most
        return limit is not None and self.missing > _SAME * max(abs(limit), abs(self.value))

    @property
    def limit(self) -> str:
        """The limit that is missed, in words; called with one that is."""
        if self.is_low:
            return at_least(self.least or 0.0)
        return at_most(self.most or 0.0)


def bound_issues(bounds: Iterable[Bound]) -> Iterator[ConfigIssue]:
    """Each figure outside of its bounds."""
    for bound in bounds:
        if bound.is_broken:
            allowed = f"{bound.limit}: {bound.why}"
            yield ConfigIssue(bound.key, f"{bound.value:g}", allowed, against=bound.against)


def at_least(limit: float) -> str:
    """The limit in words, rounded so that what is written by them keeps it."""
    return f"at least {_rounded(limit, math.ceil):g}"


def at_most(limit: float) -> str:
    """The limit in words, rounded so that what is written by them keeps it."""
    return f"at most {_rounded(limit, math.floor):g}"


def _rounded(limit: float, towards: Callable[[float], int]) -> float:
    """Four digits of the limit."""
    if limit == 0.0:
        return limit
    unit = 10.0 ** (math.floor(math.log10(abs(limit))) - 3)
    units = limit / unit
    whole = round(units)
    return unit * (whole if abs(units - whole) < 1e-6 else towards(units))
