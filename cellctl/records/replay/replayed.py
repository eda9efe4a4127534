"""Compares what the record of a run says with what the code of today computes from its data."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

SOLVED, SOLVED_SHARE = 1e-6, 1e-9
"""Difference up to which two results of a solver are the same, in the unit of the number and as a
share of it: where it stops follows from the last digits of what it is given, and these from the
number of threads that compute and from the way to mm and back. Of a length it is a nanometre."""


@dataclass(frozen=True, slots=True)
class Replayed:
    """One number of one measurement, as it was recorded and as it was computed again."""

    measurement: str
    name: str
    unit: str
    recorded: float | None
    computed: float | None
    resolution: float = 0.0
    """Resolution of the recording: a smaller difference counts as none."""

    @property
    def difference(self) -> float:
        """Computed less recorded; NaN when one of them is unknown, 0 when both are."""
        if self.recorded is None or self.computed is None:
            return 0.0 if self.recorded is self.computed else math.nan
        return self.computed - self.recorded

    @property
    def identical(self) -> bool:
        """Whether the same number comes out again."""
        return abs(self.difference) <= self.resolution


def compare(
    measurement: str,
    columns: Sequence[tuple[str, str]],
    recorded: Sequence[float | None],
    computed: Sequence[float | None],
    resolution: float = 0.0,
) -> Iterator[Replayed]:
    """One line for each column (name and unit)."""
    for (name, unit), was, found in zip(columns, recorded, computed, strict=True):
        yield Replayed(measurement, name, unit, was, found, resolution)


def solved(recorded: float | None) -> float:
    """Difference from a recorded result of a solver that counts as none."""
    return SOLVED + SOLVED_SHARE * abs(recorded or 0.0)


def compare_documents(measurement: str, recorded: Any, computed: Any) -> Iterator[Replayed]:
    """One line for each number of two documents of plain data, the results of a solver; words are
    not compared.

    A number is named by its way through the document, such as ``views.3.left_rms_px``; what one of
    the documents does not have is unknown there.
    """
    was, found = dict(_numbers(recorded, "")), dict(_numbers(computed, ""))
    for name in dict.fromkeys([*was, *found]):
        value = was.get(name)
        yield Replayed(measurement, name, "", value, found.get(name), solved(value))


def _numbers(value: Any, way: str) -> Iterator[tuple[str, float]]:
    if isinstance(value, Mapping):
        entries: Iterable[tuple[object, Any]] = value.items()
    elif isinstance(value, list | tuple):
        entries = enumerate(value, start=1)
    else:
        # What is no number is unknown in every record.
        if isinstance(value, int | float) and math.isfinite(value):
            yield way, float(value)
        return
    for key, entry in entries:
        yield from _numbers(entry, f"{way}.{key}" if way else str(key))
