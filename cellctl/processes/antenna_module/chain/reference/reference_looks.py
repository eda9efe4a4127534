"""Looks at gripper marks and plate, and the reading that they make together."""

from dataclasses import dataclass

import numpy as np

from cellctl.calibration.checks import Checks, LimitCheck
from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.chain.cell_figures import ArmFigures
from cellctl.processes.antenna_module.chain.reference.reference_check import ReferenceReading
from cellctl.processes.antenna_module.chain.teaching.tool_turn import (
    ToolTurnResult,
    TurnStop,
    calibrate_tool_turn,
)

_SCATTER_LIMIT_M = 30e-6
"""Largest standard deviation of the plate's place over the looks, each axis."""
_SIGMA_LIMIT_M = 4e-6
"""A device that has moved by 20 µm must stand out of it."""
HALF_TURN_RAD = float(np.pi)
_BESIDE_RAD = float(np.radians(3.0))
"""The marks are wider than the picture is high, so they are turned by a few degrees about 0° and
about 180° only, and stay clear of the plate's dots at the edge of the picture. Offset and axis are
as certain as with angles all round: what tells them apart is the half turn."""


def turn_angles(count: int) -> list[float]:
    """Angles of ``count`` looks, an even number, rad: in turn about 0 and about half a turn."""
    beside = np.linspace(-_BESIDE_RAD, _BESIDE_RAD, count // 2)
    return [float(angle + half) for angle in beside for half in (0.0, HALF_TURN_RAD)]


@dataclass(frozen=True, slots=True, eq=False)
class ReferenceLooks:
    """Everything that was seen, as x and y in the axes of the base, m."""

    turns: tuple[TurnStop, ...]
    """The gripper's marks less where the robot reports the flange axis."""
    plate_in_camera_1: tuple[Array, ...]
    plate_in_camera_2: tuple[Array, ...]
    lever_m: float
    """Greatest distance from the flange to what was looked at."""

    def __add__(self, other: "ReferenceLooks") -> "ReferenceLooks":
        """Both drives together."""
        return ReferenceLooks(
            self.turns + other.turns,
            self.plate_in_camera_1 + other.plate_in_camera_1,
            self.plate_in_camera_2 + other.plate_in_camera_2,
            max(self.lever_m, other.lever_m),
        )

    def turned(self) -> ToolTurnResult:
        """The flange axis and the marks beside it; raises ``TurnInvalid``."""
        return calibrate_tool_turn(self.turns)

    def reading(self, arm: ArmFigures) -> ReferenceReading:
        """The means; raises ``TurnInvalid``.

        As uncertain as the arm repeats, not as the few looks happen to scatter. Camera II sees the
        plate without the arm and is better than that.
        """
        turned = self.turned()
        one_look_m = float(np.hypot(arm.repeatability_m, arm.repeatability_rad * self.lever_m))
        fewest = min(len(self.turns), len(self.plate_in_camera_1))
        return ReferenceReading(
            axis_in_camera_2=turned.axis_m,
            marks_from_axis=turned.offset_m,
            plate_in_camera_1=np.mean(self.plate_in_camera_1, axis=0),
            plate_in_camera_2=np.mean(self.plate_in_camera_2, axis=0),
            sigma_m=one_look_m / float(np.sqrt(fewest)),
        )

    def checks(self, arm: ArmFigures) -> Checks:
        """What looks that shall be a reference have to hold."""
        scatter_m = np.std(self.plate_in_camera_1, axis=0, ddof=1).max()
        sigma_m = self.reading(arm).sigma_m
        return (
            *self.turned().checks,
            LimitCheck("plate, scatter", scatter_m / MM, _SCATTER_LIMIT_M / MM, "mm"),
            LimitCheck("sigma of a place", sigma_m / MM, _SIGMA_LIMIT_M / MM, "mm"),
        )
