"""One calibration in its file: a JSON envelope around the record of a result.

The envelope has ``format``, ``kind``, ``id``, ``made``, ``valid_until``, ``software``,
``serial_number`` and ``record``. The id is the SHA-256 of all the others: a file of which anything
was changed by hand, a date too, no longer fits its id and is refused.
"""

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
    CalibrationOfOldForm,
    CalibrationRecordInvalid,
    ClockNotTrusted,
)
from cellctl.sealed_json import content_id, fits_its_id

FORMAT = 2
"""Files of format 1 have no such field; their id is that of the record alone (``old_form``)."""

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
    """Serial number of the device that was calibrated; empty where there is none."""

    @property
    def id(self) -> str:
        """SHA-256 of everything in the envelope."""
        return content_id(envelope_of(self))

    def require_past(self, now: datetime) -> None:
        """Raise ``ClockNotTrusted`` when it was made later than ``now``."""
        require_clock_after(self.made, now, self.kind)


def require_clock_after(newest: datetime, now: datetime, what: str) -> None:
    """Raise ``ClockNotTrusted`` when the clock is behind a time stamp that it has given before."""
    # With the clock set back, a calibration that has expired would count as valid again.
    if now + CLOCK_STEP < newest:
        raise ClockNotTrusted(f"it says {now:%Y-%m-%d %H:%M:%S}, {what} {newest:%Y-%m-%d %H:%M:%S}")


def envelope_of(stored: StoredCalibration) -> dict[str, Any]:
    """The file's content but for its id."""
    return {
        "format": FORMAT,
        "kind": stored.kind,
        "made": stored.made.astimezone(UTC).isoformat(),
        "valid_until": stored.valid_until.astimezone(UTC).isoformat(),
        "software": stored.software,
        "serial_number": stored.serial_number,
        "record": stored.record,
    }


def write_stored(folder: Path, stored: StoredCalibration) -> None:
    """Write ``<kind>.json`` whole or not at all; raises ``CalibrationNotStored``."""
    content = {"id": stored.id, **envelope_of(stored)}
    text = json.dumps(content, indent=1, allow_nan=False) + "\n"
    write_file(folder / f"{stored.kind}.json", text.encode())


def read_calibration(folder: Path, kind: str) -> StoredCalibration:
    """Read a calibration that nothing has invalidated.

    Raises ``CalibrationMissing``, ``CalibrationInvalidated``, ``CalibrationRecordInvalid`` or
    ``CalibrationOfOldForm``.
    """
    require_not_invalidated(folder, kind)
    return read_stored(folder, kind)


def read_stored(folder: Path, kind: str) -> StoredCalibration:
    """Read a calibration, also one that was invalidated.

    Raises ``CalibrationMissing``, ``CalibrationRecordInvalid`` or ``CalibrationOfOldForm``.
    """
    path = folder / f"{kind}.json"
    content = read_content(path, kind)
    # Before the fields are looked at: a file of the old form has its own remedy, which is to seal
    # it anew.
    if isinstance(content, dict) and "id" in content and "format" not in content:
        raise CalibrationOfOldForm(f"{path}")
    stored, _ = parse_content(path, content)
    intact = fits_its_id(content)
    if intact and stored.kind != kind:
        raise CalibrationRecordInvalid(
            f"{path}: it holds {stored.kind}, so the file was renamed, copied or exchanged"
        )
    if not intact or content["format"] != FORMAT:
        raise CalibrationRecordInvalid(f"{path}: content does not match its id; it was changed")
    return stored


def read_content(path: Path, kind: str) -> Any:
    """The JSON of a file; raises ``CalibrationMissing`` or ``CalibrationRecordInvalid``."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise CalibrationMissing(f"{kind}: there is no {path}") from error
    except (OSError, ValueError) as error:
        raise CalibrationRecordInvalid(f"{path}: {error}") from error


def parse_content(path: Path, content: Any) -> tuple[StoredCalibration, str]:
    """What a file says, and the id that it has; raises ``CalibrationRecordInvalid``."""
    try:
        stored = StoredCalibration(
            kind=str(content["kind"]),
            record={**content["record"]},
            made=_moment(content["made"]),
            valid_until=_moment(content["valid_until"]),
            software=str(content["software"]),
            serial_number=str(content["serial_number"]),
        )
        return stored, str(content["id"])
    except (KeyError, TypeError, ValueError) as error:
        raise CalibrationRecordInvalid(f"{path}: {error!r}") from error


def _moment(text: Any) -> datetime:
    """A time with its zone; one without could be compared with no other."""
    moment = datetime.fromisoformat(text)
    if moment.tzinfo is None:
        raise ValueError(f"{text!r} has no time zone")
    return moment
