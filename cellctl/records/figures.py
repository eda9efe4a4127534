"""Figures: a value with unit, limits and verdict, one by one or from a document of plain data."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from cellctl.records.entries import Figure, Verdict
from cellctl.records.units import SIX, SIX_MM_DEG, scaled, unit_on_pages, without_unit, words


@dataclass(frozen=True, slots=True)
class Limit:
    """What a figure may be at least and at most, in its own unit; None is no limit."""

    lower: float | None = None
    upper: float | None = None

    def judge(self, value: float | None) -> Verdict | None:
        """The verdict on a value; None without any limit. A value that is unknown or not finite
        fails every limit."""
        if self.lower is None and self.upper is None:
            return None
        # A figure that could not be measured must not look like one that is within its limit.
        if value is None or not math.isfinite(value):
            return Verdict.FAIL
        above = self.lower is None or value >= self.lower
        below = self.upper is None or value <= self.upper
        return Verdict.PASS if above and below else Verdict.FAIL


NO_LIMIT = Limit()
KNOWN_TO = "_known_to"
"""Ends the key of the expanded uncertainty of a figure whose limit is the threshold at which a
correction ends. The correction looks itself at how well the value is known."""
NOT_DECIDED, NOT_MEASURED = "not decided", "not measured"
WITHIN_THRESHOLD = "within threshold, as measured"
"""Said in place of a verdict: such a threshold is no requirement on the part."""


def is_undecided(value: float | None, limit: Limit, expanded: float | None) -> bool:
    """Whether a value within its limit lies in the range of uncertainty about it, where neither
    conformity nor the opposite is proven (ISO 14253-1).

    ``expanded`` is its expanded uncertainty; None where none was evaluated, and the limit decides.
    """
    if value is None or expanded is None or limit.judge(value) is not Verdict.PASS:
        return False
    bounds = (bound for bound in (limit.lower, limit.upper) if bound is not None)
    return any(abs(bound - value) < expanded for bound in bounds)


def on_pages(figure: Figure) -> Figure:
    """The same in the unit in which people read it, limits with the value."""
    unit, factor = unit_on_pages(figure.unit)
    value, lower, upper = (
        scaled(one, factor) for one in (figure.value, figure.lower, figure.upper)
    )
    return replace(figure, unit=unit, value=value, lower=lower, upper=upper)


def verdicts(figures: Mapping[str, Figure]) -> Mapping[str, str]:
    """The verdict on each figure with a limit, in words, by their keys."""
    return {
        key: WITHIN_THRESHOLD
        if entry.verdict is Verdict.PASS and f"{key}{KNOWN_TO}" in figures
        else str(entry.verdict)
        for key, entry in figures.items()
        if entry.verdict is not None
    }


def figure(
    key: str, value: float | None, unit: str, *, label: str = "", limit: Limit = NO_LIMIT
) -> Figure:
    """A figure with its verdict; without a ``label`` the key says it in words."""
    # Unknown is None everywhere in the store: JSON has neither NaN nor infinity.
    known = None if value is None or not math.isfinite(value) else float(value)
    return Figure(
        key=key,
        label=label or ": ".join(words(part) for part in key.split(".")),
        value=known,
        unit=unit,
        lower=limit.lower,
        upper=limit.upper,
        verdict=limit.judge(known),
    )


def split_document(
    document: Mapping[str, Any], limits: Mapping[str, Limit] | None = None
) -> tuple[tuple[Figure, ...], dict[str, Any]]:
    """The numbers of a document as figures, and the document without them.

    Keys end in the unit of their value, or in that of the mapping they lie in; ``approach`` with
    ``speed_mm_s`` becomes the figure ``approach.speed`` in mm/s. Six numbers under a key that ends
    in ``_mm_deg`` become six figures. ``limits`` are by the keys of the figures.
    """
    limits = limits or {}
    numbers, rest = _split(document, "", "")
    figures = (
        figure(key, value, unit, limit=limits.get(key, NO_LIMIT)) for key, value, unit in numbers
    )
    return tuple(figures), rest


Number = tuple[str, float | None, str]
"""Key, value, unit."""


def _split(
    document: Mapping[str, Any], prefix: str, outer_unit: str
) -> tuple[list[Number], dict[str, Any]]:
    found: list[Number] = []
    rest: dict[str, Any] = {}
    for key, value in document.items():
        if isinstance(value, Mapping):
            name, unit = without_unit(key)
            inner, remaining = _split(value, f"{prefix}{name}.", unit)
            kept: Any = remaining
        else:
            inner = [
                (prefix + name, number, unit)
                for name, number, unit in _numbers(key, value, outer_unit)
            ]
            kept = None if inner else value
        found += inner
        # A mapping all of whose values became figures would be left behind empty.
        if not inner or kept:
            rest[key] = kept
    return found, rest


def _numbers(key: str, value: Any, outer_unit: str) -> Iterator[Number]:
    """Name, number and unit of each figure that a value holds; none for texts and lists."""
    name, unit = without_unit(key)
    if key.endswith(SIX_MM_DEG) and isinstance(value, Sequence) and len(value) == len(SIX):
        base = key.removesuffix(SIX_MM_DEG)
        for (axis, axis_unit), number in zip(SIX, value, strict=True):
            yield f"{base}.{axis}", number, axis_unit
    # In Python a bool is an int, but a yes or no is no figure.
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield name, value, unit or outer_unit
    elif value is None and unit:
        # A key with a unit names a number also when it is unknown.
        yield name, None, unit
