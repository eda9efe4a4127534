"""The taught reference: where axis, marks and plate were when the cell was calibrated."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cellctl.calibration.checks import Checks, all_passed, checks_from_record, evidence_to_record
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.chain.reference.reference_check import ReferenceReading
from cellctl.processes.antenna_module.chain.teaching.made_with import ReferenceMadeWith

_PLACES = ("axis_in_camera_2", "marks_from_axis", "plate_in_camera_1", "plate_in_camera_2")


@dataclass(frozen=True, slots=True, eq=False)
class TaughtReference:
    """What later checks are compared with."""

    made_with: ReferenceMadeWith
    reading: ReferenceReading
    checks: Checks

    method = "marks turned about the flange axis, plate in both cameras"

    @property
    def passed(self) -> bool:
        """The verdict."""
        return all_passed(self.checks)

    def to_record(self) -> dict[str, Any]:
        """Plain data: mm."""
        places = {f"{name}_mm": (getattr(self.reading, name) / MM).tolist() for name in _PLACES}
        return {
            **evidence_to_record(self.method, self.checks),
            "made_with": self.made_with.to_record(),
            **places,
            "sigma_mm": self.reading.sigma_m / MM,
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "TaughtReference":
        """The inverse of ``to_record``; raises ``ValueError`` for places that are none."""
        places = [np.array(record[f"{name}_mm"], dtype=float) * MM for name in _PLACES]
        sigma_m = float(record["sigma_mm"]) * MM
        if any(place.shape != (2,) for place in places):
            raise ValueError("every place has x and y")
        if not (np.isfinite(places).all() and 0.0 < sigma_m < np.inf):
            raise ValueError("places and their standard deviation must be numbers")
        axis, marks, plate_1, plate_2 = places
        return cls(
            ReferenceMadeWith.from_record(record["made_with"]),
            ReferenceReading(axis, marks, plate_1, plate_2, sigma_m),
            checks_from_record(record["checks"]),
        )
