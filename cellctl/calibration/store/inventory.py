"""Lists for operators what the folder of calibrations holds: names, dates and problems."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from cellctl.calibration.store.envelope import StoredCalibration, read_calibration
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.calibration.store.marker import marked
from cellctl.calibration.store.store import CalibrationStore
from cellctl.errors import CellError


@dataclass(frozen=True, slots=True)
class InventoryEntry:
    """One calibration; dates are None when it cannot be read."""

    name: str
    made: datetime | None
    valid_until: datetime | None
    problem: str
    """Why it may not be used; empty when it may."""
    identity: str = ""
    """The id by which runs name it; empty when it cannot be read."""


def inventory(store: CalibrationStore, now: datetime) -> tuple[InventoryEntry, ...]:
    """Every kind that production requires, missing ones too, then all others that are there.

    One of which only the marker is left counts as there: Start is refused for it.
    """
    return tuple(_entry(store, kind, now) for kind in _kinds(store))


def _kinds(store: CalibrationStore) -> Iterator[CalibrationKind[Any]]:
    required = {kind.name: kind for kind in store.kinds if kind.required and not kind.per_recipe}
    # First those that production waits for, so that an operator sees what is missing before what is
    # there besides.
    yield from required.values()
    for name in sorted({*store.names(), *marked(store.path)}):
        if name not in required:
            yield store.named(name)


def _entry(store: CalibrationStore, kind: CalibrationKind[Any], now: datetime) -> InventoryEntry:
    try:
        stored = read_calibration(store.path, kind.name)
    except CellError as error:
        return InventoryEntry(kind.name, None, None, str(error))
    problem = _problem(kind, stored, now)
    return InventoryEntry(kind.name, stored.made, stored.valid_until, problem, stored.id)


def _problem(kind: CalibrationKind[Any], stored: StoredCalibration, now: datetime) -> str:
    if not kind.accepted(stored.record):
        return "did not pass"
    return "" if stored.valid_until > now else "expired"
