"""Compares what the record of a run says with what the code of today computes from its data."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass


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
