"""One calibration in its file: a JSON envelope around the record of a result.

The envelope has ``kind``, ``id`` (SHA-256 of the record), ``made``, ``valid_until``, ``software``,
``serial_number`` and ``record``. A record that was changed by hand no longer fits its id and is
refused.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from cellctl.calibration.store.calibration_io import write_file
from cellctl.calibration.store.marker import require_not_invalidated
from cellctl.errors.calibration import (
    CalibrationMissing,
    CalibrationRecordInvalid,
    ClockNotTrusted,
)

CLOCK_STEP = timedelta(minutes=1)
"""Largest backward step of the system clock that is accepted; a synchronised clock stays within."""


@dataclass(frozen=True, slots=True)
class StoredCalibration:
    """One result in its envelope."""

    kind: str
    """Name of its kind, with the recipe's number where each recipe has its own."""
    record: Mapping[str, Any]
    made: datetime
    valid_until: datetime
    software: str
    serial_number: str
    """Of the device that was calibrated; empty where there is none."""

    @property
    def id(self) -> str:
        """SHA-256 of the record."""
        return record_id(self.record)

    def require_past(self, now: datetime) -> None:
        """Raise ``ClockNotTrusted`` when it was made later than ``now``."""
        require_clock_after(self.made, now, self.kind)


def require_clock_after(newest: datetime, now: datetime, what: str) -> None:
    """Raise ``ClockNotTrusted`` when the clock is behind a time stamp that it has given before."""
    # With the clock set back, a calibration that has expired would count as valid again.
    if now + CLOCK_STEP < newest:
        raise ClockNotTrusted(f"it says {now:%Y-%m-%d %H:%M:%S}, {what} {newest:%Y-%m-%d %H:%M:%S}")


def record_id(record: Mapping[str, Any]) -> str:
    """SHA-256 of the record in canonical JSON."""
    text = json.dumps(record, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def write_stored(folder: Path, stored: StoredCalibration) -> None:
    """Write ``<kind>.json`` whole or not at all; raises ``CalibrationNotStored``."""
    envelope = {
        "kind": stored.kind,
        "id": stored.id,
        "made": stored.made.astimezone(UTC).isoformat(),
        "valid_until": stored.valid_until.astimezone(UTC).isoformat(),
        "software": stored.software,
        "serial_number": stored.serial_number,
        "record": stored.record,
    }
    text = json.dumps(envelope, indent=1, allow_nan=False) + "\n"
    write_file(folder / f"{stored.kind}.json", text.encode())


def read_calibration(folder: Path, kind: str) -> StoredCalibration:
    """Read a calibration that nothing has invalidated.

    Raises ``CalibrationMissing``, ``CalibrationInvalidated`` or ``CalibrationRecordInvalid``.
    """
    require_not_invalidated(folder, kind)
    return read_stored(folder, kind)


def read_stored(folder: Path, kind: str) -> StoredCalibration:
    """Read a calibration, also one that was invalidated.

    Raises ``CalibrationMissing`` or ``CalibrationRecordInvalid``.
    """
    path = folder / f"{kind}.json"
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise CalibrationMissing(f"{kind}: there is no {path}") from error
    except (OSError, ValueError) as error:
        raise CalibrationRecordInvalid(f"{path}: {error}") from error
    try:
        stored = StoredCalibration(
            kind=str(data["kind"]),
            record=data["record"],
            made=datetime.fromisoformat(data["made"]),
            valid_until=datetime.fromisoformat(data["valid_until"]),
            software=str(data["software"]),
            serial_number=str(data["serial_number"]),
        )
        matches = stored.kind == kind and stored.id == data["id"]
    except (KeyError, TypeError, ValueError) as error:
        raise CalibrationRecordInvalid(f"{path}: {error!r}") from error
    if not matches:
        raise CalibrationRecordInvalid(f"{path}: content does not match its id; it was changed")
    return stored
