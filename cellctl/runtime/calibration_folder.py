"""The cell's calibrations on disk: stored by procedures, demanded by production."""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from cellctl.atomic_files import require_writable
from cellctl.calibration.base_frame import BaseFrameResult
from cellctl.calibration.files import (
    KINDS,
    CalibrationSet,
    StoredCalibration,
    read_calibration,
    read_calibration_set,
    read_stored,
    require_clock_after,
    write_stored,
)
from cellctl.calibration.invalidation import lift_invalidation, mark_invalid, marker
from cellctl.calibration.stereo_result import StereoResult
from cellctl.calibration.storing import storing, write_file
from cellctl.clock import utc_now
from cellctl.config.base import JointsDeg
from cellctl.errors import CellError
from cellctl.errors.calibration import (
    CalibrationExpired,
    CalibrationMissing,
    CalibrationRecordInvalid,
    HeadPoseChanged,
)
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.force.gravity.payload_result import gravity_compensation_from_document
from cellctl.geometry.uncertain import UncertainPose
from cellctl.runtime.commissioned import CONTACT_STIFFNESS, Commissioned, read_commissioned
from cellctl.version import software
from cellctl.vision.stereo_head import StereoHead

PAYLOAD = "payload"
ALL_KINDS = (*KINDS, PAYLOAD)
SHOWN = (("head_1", "head_2"), ("base_frame",), ("board_transfer",), (PAYLOAD,))
"""Groups whose remaining validity the line sees."""
Stamp = tuple[tuple[int, int], ...]
"""Time of change and size of every file: a file that changes, goes or comes back changes it."""


HEAD_JOINTS = "head_joints_deg"
"""Key of the board transfer's record: taught joints of each head's robot, by head."""
SAME_JOINT_DEG = 1e-4


@dataclass(frozen=True, slots=True)
class Calibrations:
    """Everything production needs, valid at the moment it was read."""

    geometry: CalibrationSet
    gravity_compensation: GravityCompensation
    ids: Mapping[str, str]
    """Identity of every record by kind."""
    serial_numbers: Mapping[str, str]
    """Of the instrument behind every record, by kind."""
    head_joints_deg: Mapping[str, Sequence[float]]
    """Of the measuring poses for which the board transfer holds, by head."""

    def require_instrument(self, kind: str, serial_number: str) -> None:
        """Raise ``CalibrationRecordInvalid`` when another instrument is connected."""
        made_for = self.serial_numbers[kind]
        if serial_number != made_for:
            raise CalibrationRecordInvalid(
                f"{kind} was made for {made_for!r}, connected is {serial_number!r}"
            )

    def require_head_pose(self, head: str, joints_deg: JointsDeg) -> None:
        """Raise ``HeadPoseChanged`` when the board transfer holds for another measuring pose."""
        made_at = self.head_joints_deg.get(head)
        if made_at is None:
            raise HeadPoseChanged(f"{head}: the board transfer does not say for which joints")
        if len(made_at) != len(joints_deg) or not np.allclose(
            made_at, joints_deg, rtol=0.0, atol=SAME_JOINT_DEG
        ):
            raise HeadPoseChanged(f"{head}: made at {list(made_at)}, taught is {list(joints_deg)}")


@dataclass(slots=True)
class CalibrationFolder:
    """Reads and writes the folder."""

    path: Path
    on_stored: list[Callable[[str], None]] = field(default_factory=list)
    """Told the kind of every record that was stored."""
    on_invalidated: list[Callable[[], None]] = field(default_factory=list)
    """Told of every invalidation: what waits for its counterpart may be worthless, too."""
    _seen: tuple[Stamp, dict[str, float]] | None = None

    def read(self, planned: timedelta) -> Calibrations:
        """All calibrations; raises when one is missing, damaged, invalidated, or not valid from
        now until ``planned`` has passed.
        """
        now = utc_now()
        until = now + planned
        geometry = read_calibration_set(self.path, now=until)
        payload = read_calibration(self.path, PAYLOAD)
        if not payload.record.get("accepted"):
            raise CalibrationMissing(f"not accepted: {PAYLOAD}")
        if payload.valid_until <= until:
            raise CalibrationExpired(f"{PAYLOAD} ({payload.valid_until:%Y-%m-%d})")
        try:
            compensation = gravity_compensation_from_document(dict(payload.record))
        except (KeyError, TypeError, ValueError) as error:
            raise CalibrationRecordInvalid(f"{PAYLOAD}: {error!r}") from error
        stored = self.stored()
        for one in stored:
            one.require_past(now)
        serial_numbers = {one.kind: one.serial_number for one in stored}
        ids = {**geometry.ids, PAYLOAD: payload.id}
        transfer = next(one.record for one in stored if one.kind == "board_transfer")
        joints_deg = transfer.get(HEAD_JOINTS, {})
        return Calibrations(geometry, compensation, ids, serial_numbers, joints_deg)

    def commissioned(self, recipe_id: int, planned: timedelta) -> Commissioned:
        """What commissioning has measured and stays valid for longer than ``planned``."""
        return read_commissioned(self.path, recipe_id, utc_now(), planned)

    def head(self, name: str) -> StereoHead:
        """One stereo head, for procedures that need it before the set is complete."""
        return StereoResult.from_record(read_calibration(self.path, name).record).head

    def c_T_base(self) -> UncertainPose:
        """The base frame, likewise."""
        return BaseFrameResult.from_record(
            read_calibration(self.path, "base_frame").record
        ).c_T_base

    def store(
        self,
        kind: str,
        record: Mapping[str, Any],
        serial_number: str,
        valid_for: timedelta,
        picture_png: bytes | None = None,
    ) -> StoredCalibration:
        """Put a record that passed into the folder, in place of the one before.

        Raises ``CalibrationNotStored``.
        """
        now = utc_now()
        plain = json.loads(json.dumps(record))  # as it will be read back
        stored = StoredCalibration(kind, plain, now, now + valid_for, software(), serial_number)
        write_stored(self.path, stored)
        if picture_png is not None:
            write_file(self.path / f"{kind}.png", picture_png)
        lift_invalidation(self.path, kind)
        self._seen = None
        for observer in self.on_stored:
            observer(kind)
        return stored

    def invalidate(self, kinds: Iterable[str], reason: str) -> list[StoredCalibration]:
        """Mark what there is of some kinds as worthless until it is made anew; what that was.

        ``contact_stiffness`` means that of every recipe. Raises ``CalibrationNotStored``.
        """
        for observer in self.on_invalidated:
            observer()
        found = [name for kind in kinds for name in self._names(kind)]
        for name in found:
            mark_invalid(self.path, name, reason, utc_now())
        self._seen = None
        return [one for name in found if (one := self._known(name)) is not None]

    def _names(self, kind: str) -> list[str]:
        pattern = f"{kind}_*.json" if kind == CONTACT_STIFFNESS else f"{kind}.json"
        files = sorted(self.path.glob(pattern))
        return [file.stem for file in files if not file.stem.endswith(".invalidated")]

    def _known(self, kind: str) -> StoredCalibration | None:
        try:
            return read_stored(self.path, kind)
        except CellError:
            return None  # it is marked; what the file cannot tell needs no entry of its own

    def put_aside(self, kind: str, record: Mapping[str, Any], picture_png: bytes | None) -> Path:
        """Keep a result that did not pass where nothing reads it; the folder.

        Raises ``CalibrationNotStored``.
        """
        folder = self.path / "rejected"
        text = json.dumps(record, indent=1) + "\n"
        write_file(folder / f"{kind}.json", text.encode())
        if picture_png is not None:
            write_file(folder / f"{kind}.png", picture_png)
        return folder

    def require_writable(self) -> None:
        """Raise ``CalibrationNotStored`` when no result could be stored here."""
        with storing(self.path):
            require_writable(self.path)

    def stored(self) -> list[StoredCalibration]:
        """Every record that production demands; raises when one is missing or damaged."""
        return [read_calibration(self.path, kind) for kind in ALL_KINDS]

    def fault(self, planned: timedelta, newest: datetime | None = None) -> CellError | None:
        """Why production may not start, or None; ``newest``: of all times that were recorded."""
        try:
            if newest is not None:
                require_clock_after(newest, utc_now(), "newest record")
            self.read(planned)
        except CellError as error:
            return error
        return None

    def validity_h(self) -> tuple[float, float, float, float]:
        """Hours left: heads, base frame, board transfer, payload; 0 when not valid.

        Reads the files again only when one of them has changed.
        """
        stamp = self._stamp()
        now = utc_now()
        if self._seen is None or self._seen[0] != stamp:
            self._seen = stamp, {kind: self._end(kind) for kind in ALL_KINDS}
        ends_s = self._seen[1]
        hours = [
            max(0.0, (min(ends_s[kind] for kind in group) - now.timestamp()) / 3600)
            for group in SHOWN
        ]
        return hours[0], hours[1], hours[2], hours[3]

    def all_valid(self, planned: timedelta = timedelta(0)) -> bool:
        """True when every calibration stays valid for longer than ``planned``."""
        return min(self.validity_h()) > planned.total_seconds() / 3600

    def _stamp(self) -> Stamp:
        files = ((self.path / f"{kind}.json", marker(self.path, kind)) for kind in ALL_KINDS)
        return tuple(_changed(file) for both in files for file in both)

    def _end(self, kind: str) -> float:
        try:
            stored = read_calibration(self.path, kind)
            stored.require_past(utc_now())
        except CellError:
            return 0.0  # not valid is what the line is told; production raises the fault itself
        return stored.valid_until.timestamp() if stored.passed or kind == PAYLOAD else 0.0


def _changed(path: Path) -> tuple[int, int]:
    try:
        status = path.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size
