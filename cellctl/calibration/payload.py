"""The payload on a force sensor as a stored calibration."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.force.gravity.payload_result import gravity_compensation_from_document, mass_kg


def payload_accepted(record: Mapping[str, Any]) -> bool:
    """How the record of an identification says that it passed: it has no ``verdict``."""
    return bool(record.get("accepted"))


@dataclass(frozen=True, slots=True)
class IdentifiedPayload:
    """What a run needs of an identification: everything else in its record is evidence."""

    gravity_compensation: GravityCompensation
    """What the guard subtracts from each reading."""
    mass_kg: float
    """Everything that hangs on the force sensor."""

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "IdentifiedPayload":
        """From the document of an identification.

        Raises ``KeyError``, ``TypeError``, ``ValueError`` or ``CalibrationRecordInvalid``.
        """
        return cls(gravity_compensation_from_document(dict(record)), mass_kg(record))
