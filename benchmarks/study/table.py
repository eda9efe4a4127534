"""What came out of a study, in numbers."""

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np
from rich.table import Table

from benchmarks.insertion.wilson import wilson_bounds
from benchmarks.study.kinds import StudyKind
from benchmarks.study.outcome import StudyOutcome
from cellctl.plot_style import Array


def tables(kind: StudyKind, outcomes: Sequence[StudyOutcome]) -> Iterator[Table]:
    """Ends with their rates, figures with their spread, and what the kind adds."""
    yield _ends(kind, outcomes)
    yield _figures(kind, outcomes)
    yield from kind.tables(outcomes)


def _ends(kind: StudyKind, outcomes: Sequence[StudyOutcome]) -> Table:
    table = Table("end", "seeds", "rate, 95 %", "first seeds", title=f"{kind.name}: {kind.about}")
    words = Counter(end(one) for one in outcomes)
    for word, count in words.most_common():
        low, high = wilson_bounds(count, len(outcomes))
        seeds = [str(one.seed) for one in outcomes if end(one) == word][:6]
        table.add_row(word, str(count), f"{100 * low:.2f} … {100 * high:.2f} %", " ".join(seeds))
    return table


def end(outcome: StudyOutcome) -> str:
    """How a trial ended; faults by their number, whose details differ from seed to seed."""
    if outcome.good:
        return "good"
    if outcome.called_good:
        return "CALLED GOOD, IS NOT"
    return outcome.fault.split(":")[0] or "not good, and called so"


def _figures(kind: StudyKind, outcomes: Sequence[StudyOutcome]) -> Table:
    good = [one for one in outcomes if one.good]
    table = Table(
        "figure", "median", "p95", "p99", "max", "limit", title=f"{len(good)} good trials"
    )
    for figure in kind.figures:
        values = values_of(figure.key, good)
        if len(values):
            numbers = (*np.percentile(values, [50, 95, 99]), values.max())
            limit = "" if figure.limit is None else f"{figure.limit:g}"
            table.add_row(figure.title, *(f"{number:.4g}" for number in numbers), limit)
    return table


def values_of(key: str, outcomes: Sequence[StudyOutcome]) -> Array:
    """A figure of all trials that have it."""
    found = [one.figures[key] for one in outcomes if key in one.figures]
    values: Array = np.array(found, dtype=float)
    finite: Array = values[np.isfinite(values)]
    return finite
