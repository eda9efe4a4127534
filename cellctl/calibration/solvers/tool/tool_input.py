"""The input file of a tool calibration."""

from typing import Annotated

from pydantic import Field

from cellctl.calibration.input_file import InputFile, InputPose
from cellctl.geometry.pose import MM


class ToolFile(InputFile):
    """Poses base_T_flange."""

    seen_from_afar = True

    touching: tuple[InputPose, ...]
    """The tip on one fixed point."""
    orienting: tuple[InputPose, ...] | None = None
    """The tip on a point, moved along +x of the tool, moved to the side of +y."""
    touch_sigma_mm: Annotated[float, Field(gt=0, le=10)] = 0.1

    @property
    def touch_sigma_m(self) -> float:
        """Standard deviation of a touch."""
        return self.touch_sigma_mm * MM
