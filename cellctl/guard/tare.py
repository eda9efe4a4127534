"""Mean and scatter of the wrench over a while, summed up sample by sample."""

import math
from dataclasses import dataclass

from cellctl.guard.limits import Six


@dataclass(frozen=True, slots=True)
class TareSums:
    """What came out."""

    mean: Six
    sigma: Six
    samples: int


class Tare:
    """Runs from the first sample after ``begin_s`` for ``duration_s`` of sample time."""

    def __init__(self, begin_s: float, duration_s: float) -> None:
        self._begin_s = begin_s
        self._end_s = begin_s + duration_s
        self._origin: Six | None = None
        self._count = 0
        self._sums = [0.0] * 6
        self._squares = [0.0] * 6

    def add(self, wrench: Six, time_s: float) -> TareSums | None:
        """Take a sample; the result once the time is over and two samples are in."""
        if time_s < self._begin_s:
            return None
        if self._origin is None:
            self._origin = wrench
        for index, (value, origin) in enumerate(zip(wrench, self._origin, strict=True)):
            difference = value - origin
            self._sums[index] += difference
            self._squares[index] += difference * difference
        self._count += 1
        return self._result(self._origin) if time_s >= self._end_s and self._count > 1 else None

    def _result(self, origin: Six) -> TareSums:
        count = self._count
        shifts = [total / count for total in self._sums]
        a, b, c, d, e, f = (value + shift for value, shift in zip(origin, shifts, strict=True))
        p, q, r, s, t, u = (
            math.sqrt(max(0.0, square / count - shift * shift) * count / (count - 1))
            for square, shift in zip(self._squares, shifts, strict=True)
        )
        return TareSums((a, b, c, d, e, f), (p, q, r, s, t, u), count)
