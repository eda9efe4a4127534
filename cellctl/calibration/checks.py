"""Figures of a calibration against their limits."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from typing import Any, Literal

Side = Literal["max", "min"]


@dataclass(frozen=True, slots=True)
class LimitCheck:
    """One figure and what it may be at most or must be at least, in the unit of reports."""

    name: str
    value: float
    limit: float
    unit: str
    side: Side = "max"

    @property
    def passed(self) -> bool:
        """False also for a value that is not a number."""
        # Written as the comparison that must hold: with NaN every comparison is false.
        return bool(self.value <= self.limit if self.side == "max" else self.value >= self.limit)

    def __str__(self) -> str:
        relation = "≤" if self.side == "max" else "≥"
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
        """The inverse of ``to_record``."""
        side: Side = "min" if record["side"] == "min" else "max"
        value, limit = float(record["value"]), float(record["limit"])
        return cls(str(record["name"]), value, limit, str(record["unit"]), side)


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
