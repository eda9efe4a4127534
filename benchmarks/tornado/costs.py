"""What an imperfection costs: the worst of its seeds, beside the same seed without it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from benchmarks.tornado.cases import ALL, NONE
from benchmarks.tornado.outcome import Outcome, Verdict

FIGURES = (
    ("lateral_mm", "offset at the pins, mm", 0.2),
    ("rotation_deg", "rotation about y or z, °", 0.01),
    ("peak_n", "peak force, N", 50.0),
)
"""Key, title, limit."""


@dataclass(frozen=True, slots=True)
class Cost:
    """One imperfection at one size, over all seeds."""

    imperfection: str
    scale: float
    place: str
    verdicts: tuple[Verdict, ...]
    texts: tuple[str, ...]
    more: dict[str, float | None]
    """Largest value beyond the reference's, by figure; None where no part was seated."""
    iterations: int | None
    """The most of all seeds."""

    def count(self, verdict: Verdict) -> int:
        """How many seeds ended so."""
        return self.verdicts.count(verdict)


def costs(outcomes: Sequence[Outcome]) -> list[Cost]:
    """Every case but the references, the dearest imperfection first."""
    reference: dict[tuple[str, int], Outcome] = {
        (one.case.place, one.case.seed): one for one in outcomes if one.case.imperfection == NONE
    }
    groups: dict[tuple[str, float, str], list[Outcome]] = {}
    for one in outcomes:
        case = one.case
        if case.imperfection != NONE and (case.place, case.seed) in reference:
            groups.setdefault((case.imperfection, case.scale, case.place), []).append(one)
    found = [_cost(key, group, reference) for key, group in groups.items()]
    weights = {
        name: max(_weight(cost) for cost in found if cost.imperfection == name)
        for name in {cost.imperfection for cost in found}
    }
    found.sort(key=lambda cost: (-weights[cost.imperfection], cost.imperfection, cost.scale))
    return found


def _cost(
    key: tuple[str, float, str],
    group: Iterable[Outcome],
    reference: dict[tuple[str, int], Outcome],
) -> Cost:
    group = list(group)
    more: dict[str, float | None] = {}
    for figure, _, _ in FIGURES:
        values = [
            getattr(one, figure) - getattr(reference[one.case.place, one.case.seed], figure)
            for one in group
            if one.seated and getattr(one, figure) is not None
        ]
        more[figure] = max(values, default=None)
    looks = [one.iterations for one in group if one.iterations is not None]
    return Cost(
        *key,
        verdicts=tuple(one.verdict for one in group),
        texts=tuple(one.text for one in group if one.text),
        more=more,
        iterations=max(looks, default=None),
    )


def _weight(cost: Cost) -> float:
    """Shares of the limits that it uses up; a part that was lost uses all, a false one more."""
    if cost.imperfection == ALL:
        return float("inf")
    used = max(abs(cost.more[key] or 0.0) / limit for key, _, limit in FIGURES)
    lost = cost.count(Verdict.NOTICED) / len(cost.verdicts)
    return used + lost + 10.0 * cost.count(Verdict.NOT_NOTICED)
