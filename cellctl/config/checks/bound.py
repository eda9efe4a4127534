"""One figure of a cell file, and what it must keep."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from cellctl.config.issue import ConfigIssue


@dataclass(frozen=True, slots=True)
class Bound:
    """Least and greatest value of a figure, with the reason."""

    key: str
    value: float
    why: str
    least: float | None = None
    most: float | None = None


def bound_issues(bounds: Iterable[Bound]) -> Iterator[ConfigIssue]:
    """Each figure outside of its bounds."""
    for bound in bounds:
        if bound.least is not None and bound.value < bound.least:
            allowed = f"at least {bound.least:.4g}: {bound.why}"
        elif bound.most is not None and bound.value > bound.most:
            allowed = f"at most {bound.most:.4g}: {bound.why}"
        else:
            continue
        yield ConfigIssue(bound.key, f"{bound.value:g}", allowed)
