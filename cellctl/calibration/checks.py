"""Figures of a calibration against their limits."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from typing import Any, Literal

Side = Literal["max", "min", "both"]
"""What a limit is: the most, the least, or the most of the magnitude."""
RELATIONS: Mapping[Side, str] = {"max": "≤", "min": "≥", "both": "within ±"}
"""What stands between a figure and its limit, by the side."""


@dataclass(frozen=True, slots=True)
class LimitCheck:
    """One figure and its limit, in the unit of reports."""

    name: str
    value: float
    limit: float
    unit: str
    side: Side = "max"

    @property
    def bounds(self) -> tuple[float | None, float | None]:
        """Least and most that the value may be; None for no bound on that side."""
        least = {"max": None, "min": self.limit, "both": -self.limit}[self.side]
        return least, None if self.side == "min" else self.limit

    @property
    def passed(self) -> bool:
        """False also for a value that is not a number."""
        least, most = self.bounds
        # Written as the comparisons that must hold: with NaN every comparison is false.
        return bool((least is None or self.value >= least) and (most is None or self.value <= most))

    def __str__(self) -> str:
        relation = RELATIONS[self.side]
        if isnan(self.value):
            limit = f"{self.limit:.4g} {self.unit}".rstrip()
            return f"{self.name} not measured ({relation} {limit})"
        mark = "ok" if self.passed else "OUT OF LIMIT"
        value = f"{self.value:.4g} {self.unit}".rstrip()
        return f"{self.name} {value} ({relation} {self.limit:.4g}): {mark}"

    def to_record(self) -> dict[str, Any]:
        """Plain data for the store."""
        return {
            "name": self.name,
            "value": float(self.value),
            "limit": float(self.limit),
            "unit": self.unit,
            "side": self.side,
            "passed": self.passed,
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "LimitCheck":
        """The inverse of ``to_record``.

        Without a side, as in payloads of older versions, the limit is one of the magnitude. Raises
        ``KeyError`` or ``ValueError`` for what is no check.
        """
        written = record.get("side", "both")
        if written not in RELATIONS:
            raise ValueError(f"side {written!r} of a limit")
        value, limit = float(record["value"]), float(record["limit"])
        return cls(str(record["name"]), value, limit, str(record["unit"]), written)


Checks = tuple[LimitCheck, ...]


def all_passed(checks: Iterable[LimitCheck]) -> bool:
    """The verdict."""
    return all(check.passed for check in checks)


def evidence_to_record(method: str, checks: Checks, warnings: Sequence[str] = ()) -> dict[str, Any]:
    """What the records of all calibrations begin with."""
    return {
        "method": method,
        "verdict": "pass" if all_passed(checks) else "fail",
        "checks": [check.to_record() for check in checks],
        "warnings": list(warnings),
    }


def checks_from_record(records: Sequence[Mapping[str, Any]]) -> Checks:
    """The checks of a record."""
    return tuple(LimitCheck.from_record(record) for record in records)
