"""The same figures as a table in Markdown, for the documentation."""

from collections.abc import Sequence

from benchmarks.tornado.costs import FIGURES, Cost
from benchmarks.tornado.outcome import Verdict
from fakes.imperfections import CATALOGUE

_DECIMALS = {"lateral_mm": 3, "rotation_deg": 4, "peak_n": 1}


def markdown(found: Sequence[Cost]) -> str:
    """One line for each imperfection and size."""
    titles = [f"{title} more" for _, title, _ in FIGURES]
    head = ["imperfection", "size", "tried on", *titles, "looks", "good", "noticed", "NOT NOTICED"]
    lines = [_line(head), _line(["---"] * len(head))]
    lines += [_line(_cells(cost)) for cost in found]
    return "\n".join(lines) + "\n"


def _cells(cost: Cost) -> list[str]:
    more = [_more(cost.more[key], _DECIMALS[key]) for key, _, _ in FIGURES]
    counts = [str(cost.count(verdict)) for verdict in Verdict]
    looks = "–" if cost.iterations is None else str(cost.iterations)
    return [cost.imperfection, _size(cost), cost.place, *more, looks, *counts]


def _more(value: float | None, decimals: int) -> str:
    # Adding zero makes 0.0 of the -0.0 that rounding leaves of a small negative value.
    return "–" if value is None else f"{round(value, decimals) + 0.0:+.{decimals}f}"


def _size(cost: Cost) -> str:
    one = CATALOGUE.get(cost.imperfection)
    if one is None or not one.unit:
        return f"{cost.scale:g} ×"
    return f"{cost.scale:g} × = {cost.scale * one.size:.3g} {one.unit}"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"
