"""Says of figures that contradict each other which ones take part, and what each would have to be.

Which figures a bound follows from is found by changing each of them a little, so that no check has
to list them. Nothing decides which of them is wrong. So each is named with the value that it would
have to be with all others as they are, but for values that its key cannot have, and for those that
would break another bound. What is less safe by the key's own words (``LessSafe``) comes last.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from cellctl.config.base import LessSafe
from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound, at_least, at_most
from cellctl.config.checks.bounds.changed import figures, is_number, with_figure
from cellctl.config.checks.bounds.edge import farthest_allowed
from cellctl.config.checks.bounds.less_safe import less_safe
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.config.recipe import Recipe

Bounds = Callable[[CellConfig, Recipe], Iterable[Bound]]
"""All bounds of a recipe in a cell, in an order that does not depend on their figures."""

_LITTLE = 1e-3
"""Share, or millimetres and degrees, by which a figure is changed to see whether it takes part."""
_NO_CHANGE = 1e-6
"""Share of what is missed, below which it has not changed."""
_MOST_TIMES = 1e4
"""Other values are looked for up to this multiple of the written one, and down to this part of
it."""
_EXACT = 1e-11
"""Share to which a way out is found: finer than the digits by which ``at_least`` and ``at_most``
tell a limit that is round from one that has to be rounded."""
_LESS_SAFE = " (the less safe way)"


@dataclass(frozen=True, slots=True)
class _Part:
    """A value that takes part."""

    key: str
    value: str
    allowed: str = ""
    less_safe: str = ""
    """What is said of a way out that is less safe than what is written."""

    @property
    def rank(self) -> int:
        """The safest way out first, and none last."""
        return 2 if not self.allowed else int(bool(self.less_safe))

    @property
    def written(self) -> WrittenValue:
        """With what it would have to be."""
        return WrittenValue(self.key, self.value, allowed=self.allowed + self.less_safe)


def contradictions(
    cell: CellConfig, recipe: Recipe, key: str, bounds: Bounds
) -> Iterator[ConfigIssue]:
    """Every bound that is broken; one mistake is told once. ``key`` is the path of the recipe.

    What a figure is by itself is told first, and no contradiction in which it takes part.
    """
    subject = _Subject(cell, recipe, key, bounds)
    before = list(bounds(cell, recipe))
    broken = [index for index, bound in enumerate(before) if bound.is_broken]
    taking = {index: _Search(subject, before, index) for index in broken}
    told: set[str] = set()
    for index in sorted(broken, key=lambda one: bool(taking[one].others)):
        keys = {before[index].key, *taking[index].others}
        if keys & told:
            continue
        issue = taking[index].issue()
        told.add(issue.key)
        yield issue


@dataclass(frozen=True, slots=True, eq=False)
class _Subject:
    """A recipe in its cell, and what it has to keep."""

    cell: CellConfig
    recipe: Recipe
    key: str
    bounds: Bounds

    def changed(self, name: str, value: Any) -> list[Bound] | None:
        """The bounds with another value of one key; None for a value that the key cannot have."""
        try:
            changed = with_figure(self.cell, self.recipe, self.key, name, value)
            return list(self.bounds(*changed))
        except (ValueError, ArithmeticError):
            return None

    def less_safe(self, name: str) -> LessSafe | None:
        """Which other values of a key are less safe."""
        return less_safe(self.cell, self.recipe, self.key, name)


class _Search:
    """What takes part in one broken bound."""

    def __init__(self, subject: _Subject, before: Sequence[Bound], index: int) -> None:
        self._subject = subject
        self._bound = before[index]
        self._nth = sum(one.key == self._bound.key for one in before[:index])
        self._broken = {one.key for one in before if one.is_broken}
        self._figures = figures(subject.cell, subject.recipe, subject.key)
        self.others = [
            name
            for name, value in self._figures.items()
            if name != self._bound.key and self._takes_part(name, value)
        ]

    def issue(self) -> ConfigIssue:
        """The safest way out first, all others behind it."""
        bound = self._bound
        if not self.others:
            allowed = f"{bound.limit}: {bound.why}"
            return ConfigIssue(bound.key, f"{bound.value:g}", allowed, against=bound.against)
        own = self._own()
        parts = sorted(
            (own, *(self._other(name) for name in self.others)), key=lambda one: one.rank
        )
        if parts[0].rank > 0:
            parts = [replace(one, less_safe="") for one in parts]  # there is no safer way
        first, *behind = parts
        against = (*(one.written for one in behind), *bound.against)
        if first.key == bound.key:
            allowed = f"{first.allowed or 'no value that helps alone'}: {bound.why}"
        else:
            name, value = bound.key.rsplit(".", 1)[-1], f"{bound.value:g}"
            wrong = "too low" if bound.is_low else "too high"
            allowed = f"{first.allowed}, or {name} = {value} is {wrong}: {bound.why}"
        return ConfigIssue(first.key, first.value, allowed, against=against)

    def _own(self) -> _Part:
        bound = self._bound
        limit = bound.least if bound.is_low else bound.most
        assert limit is not None
        value = f"{bound.value:g}"
        is_figure = is_number(self._figures.get(bound.key))
        if is_figure and not self._is_possible(bound.key, limit):
            return _Part(bound.key, value)
        return self._part(bound.key, value, bound.limit, raised=bound.is_low)

    def _other(self, name: str) -> _Part:
        value = self._figures[name]
        shown = f"{value:g}" if is_number(value) else str(list(value))
        limit = self._solved(name, value) if is_number(value) else None
        if limit is None:
            return _Part(name, shown)
        raised = limit > value
        words = at_least(limit) if raised else at_most(limit)
        return self._part(name, shown, words, raised=raised)

    def _missing(self, name: str, value: Any) -> float | None:
        """By how much the bound is missed with another value; None for one that cannot be."""
        bounds = self._subject.changed(name, value)
        same = [one for one in bounds or () if one.key == self._bound.key]
        return same[self._nth].missing if len(same) > self._nth else None

    def _takes_part(self, name: str, value: Any) -> bool:
        if is_number(value):
            little = _LITTLE * (abs(value) or 1.0)
            trials: list[Any] = [value + little, value - little]
        else:
            trials = [
                [*value[:place], one + _LITTLE * max(abs(one), 1.0), *value[place + 1 :]]
                for place, one in enumerate(value)
            ]
        missed = (self._missing(name, trial) for trial in trials)
        scale = abs(self._bound.missing)
        return any(
            one is not None and abs(one - self._bound.missing) > _NO_CHANGE * scale
            for one in missed
        )

    def _solved(self, name: str, value: float) -> float | None:
        """The value nearest to the written one with which the bound is kept."""
        for times in (2.0, 10.0, 100.0, _MOST_TIMES):
            for far in (value / times, value * times):
                if self._keeps(name, far):
                    within = _EXACT * min(abs(value), abs(far))
                    near = farthest_allowed(far, value, partial(self._keeps, name), within=within)
                    return near if self._is_possible(name, near) else None
        return None

    def _keeps(self, name: str, value: float) -> bool:
        """Whether the bound is kept with another value."""
        missing = self._missing(name, value)
        return missing is not None and missing <= 0.0

    def _is_possible(self, name: str, value: float) -> bool:
        """Whether the key may have the value, and no bound is broken by it that was kept."""
        raised = value > float(self._figures[name])
        # Within the digits that are shown.
        bounds = self._subject.changed(name, value * (1.0 + (1e-3 if raised else -1e-3)))
        return bounds is not None and {one.key for one in bounds if one.is_broken} <= self._broken

    def _part(self, name: str, value: str, limit: str, *, raised: bool) -> _Part:
        less_safe = self._subject.less_safe(name)
        risky = less_safe is (LessSafe.WITH_MORE if raised else LessSafe.WITH_LESS)
        return _Part(name, value, limit, _LESS_SAFE if risky else "")
