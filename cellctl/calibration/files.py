"""The calibrations that production needs, as a folder of JSON files.

Each file is an envelope about the record of one result: ``kind``, ``id`` (SHA-256 of the
record), ``made``, ``valid_until``, ``software``, ``serial_number`` and ``record``. A changed
record no longer fits its id and is refused.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from cellctl.calibration.base_frame import BaseFrameResult
from cellctl.calibration.board_transfer import TransferResult
from cellctl.calibration.checks import require_passed
from cellctl.calibration.invalidation import require_not_invalidated
from cellctl.calibration.stereo_result import StereoResult
from cellctl.calibration.storing import write_file
from cellctl.errors.calibration import (
    CalibrationExpired,
    CalibrationMissing,
    CalibrationRecordInvalid,
    ClockNotTrusted,
)
from cellctl.geometry.uncertain import UncertainPose
from cellctl.version import software
from cellctl.vision.stereo_head import StereoHead

KINDS = ("head_1", "head_2", "base_frame", "board_transfer")
CLOCK_STEP = timedelta(minutes=1)
"""By so much a synchronised clock may be set back."""


@dataclass(frozen=True, slots=True)
class StoredCalibration:
    """One result in its envelope."""

    kind: str
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

    @property
    def passed(self) -> bool:
        """The verdict that was stored with the result."""
        return self.record.get("verdict") == "pass"


@dataclass(frozen=True, slots=True)
class CalibrationSet:
    """What production reads; the payload's identification is kept by the force part."""

    head_1: StereoResult
    head_2: StereoResult
    base_frame: BaseFrameResult
    transfer: TransferResult
    ids: Mapping[str, str]
    """Identity of each record by kind, for the run record."""

    @property
    def heads(self) -> tuple[StereoHead, StereoHead]:
        """Cameras of head I and head II."""
        return self.head_1.head, self.head_2.head

    @property
    def c_T_base(self) -> UncertainPose:
        """Base of the main robot in the large-field head."""
        return self.base_frame.c_T_base

    @property
    def base_T_c1(self) -> UncertainPose:
        """Head I in the base."""
        return self.transfer.base_T_c1

    @property
    def base_T_c2(self) -> UncertainPose:
        """Head II in the base."""
        return self.transfer.base_T_c2

    @property
    def c1_T_c2(self) -> UncertainPose:
        """Head II in head I."""
        return self.transfer.c1_T_c2


def require_clock_after(newest: datetime, now: datetime, what: str) -> None:
    """Raise ``ClockNotTrusted`` when the clock is behind something that was stamped before.

    With the clock set back, what has expired would count again.
    """
    if now + CLOCK_STEP < newest:
        raise ClockNotTrusted(f"it says {now:%Y-%m-%d %H:%M:%S}, {what} {newest:%Y-%m-%d %H:%M:%S}")


def record_id(record: Mapping[str, Any]) -> str:
    """SHA-256 of the record in canonical JSON."""
    text = json.dumps(record, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def write_calibration(
    folder: Path,
    kind: str,
    result: StereoResult | BaseFrameResult | TransferResult,
    *,
    made: datetime,
    valid_until: datetime,
    serial_number: str = "",
) -> StoredCalibration:
    """Write ``<kind>.json`` whole or not at all.

    Raises ``ResultOutOfLimits`` if not passed, ``CalibrationNotStored`` if it cannot be written.
    """
    require_passed(result.checks)
    stored = StoredCalibration(
        kind, result.to_record(), made, valid_until, software(), serial_number
    )
    write_stored(folder, stored)
    return stored


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
    """Read one that nothing has invalidated.

    Raises ``CalibrationMissing``, ``CalibrationInvalidated`` or ``CalibrationRecordInvalid``.
    """
    require_not_invalidated(folder, kind)
    return read_stored(folder, kind)


def read_stored(folder: Path, kind: str) -> StoredCalibration:
    """Read one, also an invalidated one.

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


def read_calibration_set(folder: Path, *, now: datetime | None = None) -> CalibrationSet:
    """Read all; with ``now`` also refuse what is no longer valid then.

    Raises what ``read_calibration`` raises, and ``CalibrationExpired``.
    """
    stored = {kind: read_calibration(folder, kind) for kind in KINDS}
    rejected = [kind for kind, one in stored.items() if not one.passed]
    if rejected:
        raise CalibrationMissing(f"not accepted: {', '.join(rejected)}")
    if now is not None:
        expired = [f"{kind} ({one.valid_until:%Y-%m-%d})" for kind, one in stored.items()
                   if one.valid_until <= now]  # fmt: skip
        if expired:
            raise CalibrationExpired(", ".join(expired))
    try:
        return CalibrationSet(
            head_1=StereoResult.from_record(stored["head_1"].record),
            head_2=StereoResult.from_record(stored["head_2"].record),
            base_frame=BaseFrameResult.from_record(stored["base_frame"].record),
            transfer=TransferResult.from_record(stored["board_transfer"].record),
            ids={kind: one.id for kind, one in stored.items()},
        )
    except (KeyError, TypeError, ValueError) as error:
        raise CalibrationRecordInvalid(f"{folder}: {error!r}") from error
