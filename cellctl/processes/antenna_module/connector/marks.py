"""The drawing of the marks on the gripper, and where they expect the plug.

Frame of the marks: z towards the camera that looks up at them, as the plug's.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.connector.arrangement import (
    HALF_TURN,
    asymmetry_m,
    mirror_asymmetry_m,
)
from cellctl.processes.antenna_module.connector.connector import least_spacing
from cellctl.processes.antenna_module.connector.toml_file import (
    Name,
    PositionMm,
    PositiveMm,
    Table,
    parse_toml,
    read_bytes,
)
from cellctl.processes.antenna_module.faults.connector import MarksFileInvalid

_FEWEST = 3
_PLACES = frozenset(
    {"kind", "diameter_mm", "height_mm", "connector_mm", "connector_yaw_deg", "mark"}
)


@dataclass(frozen=True, slots=True, eq=False)
class Marks:
    """Discs on the gripper, all of one size, in one plane; m."""

    name: str
    bright: bool
    """Bright discs on a dark ground; otherwise dark ones on a bright ground."""
    names: tuple[str, ...]
    positions_m: Array
    """x and y, shape (n, 2)."""
    diameter_m: float
    height_m: float
    """Height of the marks' plane over that of the contacts, towards the camera."""
    marks_T_connector: RigidTransform
    """Where the plug sits when it is gripped as drawn, in the plane."""
    within_m: float
    """How far off its place a plug may be gripped."""
    within_rad: float
    places_id: str
    """Identity of everything that says where the marks are."""


class _MarkTable(Table):
    name: Name
    position_mm: PositionMm


class MarksTable(Table):
    """The file, in mm and degrees."""

    name: Name
    kind: Literal["bright", "dark"] = "bright"
    diameter_mm: PositiveMm
    height_mm: Annotated[float, Field(ge=-100, le=100)]
    connector_mm: PositionMm = (0.0, 0.0)
    connector_yaw_deg: Annotated[float, Field(ge=-180, le=180)] = 0.0
    within_mm: PositiveMm = 1.0
    within_deg: Annotated[float, Field(gt=0, le=45)] = 1.0
    mark: Annotated[tuple[_MarkTable, ...], Field(min_length=_FEWEST, max_length=40)]

    @model_validator(mode="after")
    def _tell_every_way_apart(self) -> Self:
        names = [mark.name for mark in self.mark]
        if len(set(names)) != len(names):
            raise ValueError("every mark needs a name of its own")
        points = self.points_mm()
        if least_spacing(points) <= self.diameter_mm:
            raise ValueError("two marks overlap")
        # The marks are what tells half a turn and a mirrored image from a good one, where the
        # contacts cannot.
        if asymmetry_m(points, HALF_TURN) < self.diameter_mm / 2:
            raise ValueError("the marks look the same after half a turn")
        if mirror_asymmetry_m(points) < self.diameter_mm / 2:
            raise ValueError("the marks look the same in a mirror")
        return self

    def points_mm(self) -> Array:
        """Positions, shape (n, 2)."""
        return np.array([mark.position_mm for mark in self.mark])


def read_marks(path: Path) -> Marks:
    """Read a file of marks; raises ``MarksFileInvalid`` with everything that is wrong."""
    return parse_marks(read_bytes(path, MarksFileInvalid), str(path))


def parse_marks(content: bytes, name: str) -> Marks:
    """The content of a file of marks of that name; raises ``MarksFileInvalid``."""
    table = parse_toml(content, name, MarksTable, MarksFileInvalid)
    turn = Rotation.from_euler("z", table.connector_yaw_deg, degrees=True)
    place_m = np.array([*table.connector_mm, -table.height_mm]) * MM
    return Marks(
        name=table.name,
        bright=table.kind == "bright",
        names=tuple(mark.name for mark in table.mark),
        positions_m=table.points_mm() * MM,
        diameter_m=table.diameter_mm * MM,
        height_m=table.height_mm * MM,
        marks_T_connector=RigidTransform.from_components(place_m, turn),
        within_m=table.within_mm * MM,
        within_rad=float(np.radians(table.within_deg)),
        places_id=table.id_of(_PLACES),
    )
