"""Calibrations as the records have them, those that are replaced or void included."""

from collections.abc import Mapping
from typing import Any

from cellctl.hmi.answers.form import Form, Time
from cellctl.records.entries import Calibration


class CheckTold(Form):
    """A figure of a calibration against its limit."""

    name: str
    value: float | None
    limit: float | None
    unit: str
    side: str
    """What the limit is: `max`, `min`, or `both` for a bound of the magnitude."""
    passed: bool


class CalibrationTold(Form):
    """One calibration that a procedure has stored or a run has used."""

    id: str
    """Identity, by which runs name it."""
    kind: str
    serial_number: str
    """Of the device that was calibrated; empty where it has none."""
    software: str
    made: Time
    valid_until: Time
    invalidated: Time | None
    """Since when it is void, whatever its date says."""
    invalidated_reason: str | None
    in_use: bool | None
    """The cell has it now; null when the cell has not said anything since the page started."""
    problem: str | None
    """Why the cell would not use it; null where it is not in use, empty where nothing is wrong."""
    checks: tuple[CheckTold, ...]
    """Figures with limits; none for a kind that states none."""


class CalibrationRecord(CalibrationTold):
    """One calibration with all that was measured."""

    record: dict[str, Any]
    """Content of its file; its keys depend on the kind."""


class CalibrationList(Form):
    """Calibrations, the newest first."""

    calibrations: tuple[CalibrationTold, ...]


class CellCalibrations:
    """Which calibrations the cell has now, from what the daemon describes."""

    def __init__(self, description: Mapping[str, Any]) -> None:
        self._said = "calibrations" in description
        entries = description.get("calibrations", ())
        self._problems = {one["identity"]: one["problem"] for one in entries if one.get("identity")}

    def told(self, kept: Calibration) -> CalibrationTold:
        """A calibration of the records, and whether the cell has it."""
        return CalibrationTold(**self._fields(kept))

    def record(self, kept: Calibration) -> CalibrationRecord:
        """The same with its content."""
        return CalibrationRecord(**self._fields(kept), record=dict(kept.record))

    def _fields(self, kept: Calibration) -> dict[str, Any]:
        return {
            "id": kept.id,
            "kind": kept.kind,
            "serial_number": kept.serial_number,
            "software": kept.software,
            "made": kept.made,
            "valid_until": kept.valid_until,
            "invalidated": kept.invalidated,
            "invalidated_reason": kept.invalidated_reason,
            "in_use": kept.id in self._problems if self._said else None,
            "problem": self._problems.get(kept.id),
            "checks": tuple(_check(one) for one in kept.record.get("checks", ())),
        }


def _check(one: Mapping[str, Any]) -> CheckTold:
    return CheckTold(
        name=one["name"],
        value=one.get("value"),
        limit=one.get("limit"),
        unit=one.get("unit", ""),
        side=one.get("side", "both"),
        passed=one["passed"],
    )
