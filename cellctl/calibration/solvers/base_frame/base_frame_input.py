"""The input file of a base-frame calibration."""

from typing import Annotated, Any

import numpy as np
from pydantic import Field, PlainValidator

from cellctl.calibration.input_file import InputFile, InputPosition, numbers
from cellctl.calibration.solvers.base_frame.axis_fit import AxisStop
from cellctl.calibration.solvers.base_frame.base_frame import ArmGeometry
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces.target_tracker import Target


def _joints_rad(values: Any) -> Array:
    return np.radians(numbers(values, (6,), "joints_deg must be six numbers"))


class TargetEntry(InputFile):
    """A target as the large-field head sees it."""

    name: str
    position_mm: InputPosition
    sigma_mm: Annotated[float, Field(gt=0, le=10)] = 0.05


class StopEntry(InputFile):
    """The arm at rest."""

    joints_deg: Annotated[Array, PlainValidator(_joints_rad)]
    """Written in degrees, kept in rad."""
    targets: tuple[TargetEntry, ...]

    def stop(self) -> AxisStop:
        """The stop as the solver takes it."""
        targets = (
            Target(target.name, target.position_mm, target.sigma_mm * MM) for target in self.targets
        )
        return AxisStop(self.joints_deg, tuple(targets))


class BaseFrameFile(InputFile):
    """The whole file: two links of the arm, and the stops of axes A1 and A2."""

    seen_from_afar = True

    # As in the cell file. The stops fit with any length, so metres would pass unseen.
    d1_mm: Annotated[float, Field(ge=100, le=3000)]
    a1_mm: Annotated[float, Field(ge=0, le=2000)]
    a1_sign: int = 1
    a2_sign: int = 1
    a1_zero_deg: float = 0.0
    a1: tuple[StopEntry, ...]
    a2: tuple[StopEntry, ...]

    def arm(self) -> ArmGeometry:
        """The first links of the robot."""
        return ArmGeometry(
            d1_m=self.d1_mm * MM,
            a1_m=self.a1_mm * MM,
            a1_sign=self.a1_sign,
            a2_sign=self.a2_sign,
            a1_zero_rad=float(np.radians(self.a1_zero_deg)),
        )
