"""The calibrations that a run uses, as they were when it started."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.calibration.store.kind import CalibrationKind, T
from cellctl.errors.calibration import (
    CalibrationMissing,
    CalibrationRecordInvalid,
    HeadPoseChanged,
)

SAME_JOINT_DEG = 1e-4
"""Joints that differ by less are the same taught pose; files round to more digits."""


@dataclass(frozen=True, slots=True)
class CalibrationSnapshot:
    """Results with the records they come from, all valid at the moment they were read."""

    results: Mapping[str, Any]
    """Parsed results by name of their kind."""
    stored: Mapping[str, StoredCalibration]
    """Their records by name of their kind, in the order in which they were asked for."""

    def get(self, kind: CalibrationKind[T]) -> T:
        """The result of a kind; raises ``CalibrationMissing`` when the snapshot has none."""
        found = self.find(kind)
        if found is None:
            raise CalibrationMissing(f"{kind.name}: was not read for this run")
        return found

    def find(self, kind: CalibrationKind[T]) -> T | None:
        """The result of a kind that is not required, or None."""
        return self.results.get(kind.name)

    @property
    def records(self) -> list[StoredCalibration]:
        """All records, for the run store."""
        return list(self.stored.values())

    @property
    def ids(self) -> dict[str, str]:
        """Identity of every record by name of its kind."""
        return {name: one.id for name, one in self.stored.items()}

    @property
    def serial_numbers(self) -> dict[str, str]:
        """Serial number of the device behind every record, by name of its kind."""
        return {name: one.serial_number for name, one in self.stored.items()}

    def require_instrument(self, kind: CalibrationKind[Any], serial_number: str) -> None:
        """Raise ``CalibrationRecordInvalid`` when another device is connected."""
        made_for = self.stored[kind.name].serial_number
        if serial_number != made_for:
            raise CalibrationRecordInvalid(
                f"{kind.name} was made for {made_for!r}, connected is {serial_number!r}"
            )

    def require_taught_pose(
        self, kind: CalibrationKind[Any], role: str, joints_deg: Sequence[float]
    ) -> None:
        """Raise ``HeadPoseChanged`` when the calibration holds for other joints of this role."""
        record = self.stored[kind.name].record
        made_at = record.get(kind.holds_for or "", {}).get(role)
        # A record that does not say for which joints it holds may hold for others than the taught
        # ones.
        if made_at is None:
            raise HeadPoseChanged(f"{role}: {kind.name} does not say for which joints")
        if len(made_at) != len(joints_deg) or not np.allclose(
            made_at, joints_deg, rtol=0.0, atol=SAME_JOINT_DEG
        ):
            raise HeadPoseChanged(f"{role}: made at {list(made_at)}, taught is {list(joints_deg)}")
