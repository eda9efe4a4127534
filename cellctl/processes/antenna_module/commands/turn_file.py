"""The file of ``cellctl calibrate tool-turn``."""

from typing import Annotated

import numpy as np
from pydantic import Field, PlainValidator, model_validator

from cellctl.calibration.input_file import InputFile, InputPose, numbers
from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.chain.teaching.tool_turn import TurnStop


def _planar_m(values: object) -> Array:
    return numbers(values, (2,), "position_mm must be two numbers") * MM


class TurnEntry(InputFile):
    """One angle."""

    a6_deg: Annotated[float, Field(ge=-720, le=720)]
    position_mm: Annotated[Array, PlainValidator(_planar_m)] | None = None
    """x and y of the feature in the axes of the camera."""
    camera_T_marks: InputPose | None = None

    @model_validator(mode="after")
    def _has_one_place(self) -> "TurnEntry":
        if (self.position_mm is None) == (self.camera_T_marks is None):
            raise ValueError("give either 'position_mm' or 'camera_T_marks'")
        return self

    def stop(self) -> TurnStop:
        """Input of the solver."""
        seen = self.position_mm
        if seen is None and self.camera_T_marks is not None:
            seen = self.camera_T_marks.translation[:2]
        return TurnStop(float(np.radians(self.a6_deg)), np.asarray(seen))


class TurnFile(InputFile):
    """The whole file."""

    turns: tuple[TurnEntry, ...]
