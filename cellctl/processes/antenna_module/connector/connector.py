"""The drawing of a connector: where its contacts are, and how it wants to be plugged.

Frame of the drawing: z points out of the mating face, towards whoever looks at it; x along the
rows, y towards the longer row. Its height is that of the shoulders of the pins, where their full
section begins, or of the face with the holes.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.connector.arrangement import HALF_TURN, asymmetry_m
from cellctl.processes.antenna_module.connector.toml_file import (
    Name,
    PositionMm,
    PositiveMm,
    Table,
    parse_toml,
    read_bytes,
)
from cellctl.processes.antenna_module.faults.connector import ConnectorFileInvalid

Kind = Literal["pins", "holes"]
_FEWEST = 3
_PLACES = frozenset(
    {"kind", "diameter_mm", "length_mm", "rim_depth_mm", "chamfer_mm", "seat_depth_mm", "contact"}
)
_LIMIT_N = Field(gt=0, le=1000)


@dataclass(frozen=True, slots=True, eq=False)
class Connector:
    """One plug or socket; m and N."""

    name: str
    kind: Kind
    contacts: tuple[str, ...]
    """Names, in the order of the file."""
    positions_m: Array
    """x and y of the contacts, shape (n, 2)."""
    diameter_m: float
    """Diameter of a pin, or of the bore of a hole below its funnel."""
    length_m: float
    """What stands out of the insulator; depth of a hole."""
    rim_depth_m: float
    """How far below z = 0 the rim lies that an image shows, as the end of a funnel. Seen off the
    camera's axis a deeper rim appears nearer to the axis."""
    chamfer_m: float
    """Chamfer of the tip of a pin, at 45°: the flat stands out over the rim by this; 0 for
    holes."""
    true_position_m: float
    """Standard deviation per axis of a good contact's place."""
    symmetric: bool
    """Half a turn gives the same picture."""
    capture_m: float
    """Offset up to which a contact still finds its hole."""
    funnel_m: float
    """Depth over which the hole narrows."""
    seat_depth_m: float
    """Depth at which the connector is seated, from the first touch of tips and face."""
    spring_depth_m: float
    """Depth at which the contact springs begin."""
    force_n: tuple[float, float]
    """Axial force of a good plugging: least and greatest."""
    outline_m: tuple[float, float]
    """Sides of the insulator along x and y."""
    places_id: str
    """Identity of everything that says where contacts are and where the connector sits. Forces and
    tolerances are not in it: what was taught holds with others, too."""

    @property
    def least_spacing_m(self) -> float:
        """Distance of the two contacts that are nearest to each other."""
        return least_spacing(self.positions_m)


class _ContactTable(Table):
    name: Name
    position_mm: PositionMm


class ConnectorTable(Table):
    """The file, in mm and N."""

    name: Name
    kind: Kind
    diameter_mm: PositiveMm
    length_mm: PositiveMm
    rim_depth_mm: Annotated[float, Field(ge=0, le=10)] = 0.0
    chamfer_mm: Annotated[float, Field(ge=0, le=10)] = 0.0
    true_position_mm: Annotated[float, Field(gt=0, le=1)]
    symmetric: bool = False
    capture_mm: PositiveMm
    funnel_mm: PositiveMm
    seat_depth_mm: PositiveMm
    spring_depth_mm: PositiveMm
    force_n: tuple[Annotated[float, _LIMIT_N], Annotated[float, _LIMIT_N]]
    outline_mm: tuple[PositiveMm, PositiveMm]
    contact: Annotated[tuple[_ContactTable, ...], Field(min_length=_FEWEST, max_length=400)]

    @model_validator(mode="after")
    def _contacts_are_apart(self) -> Self:
        names = [contact.name for contact in self.contact]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"contact {twice[0]} is named twice")
        points = self.points_mm()
        apart = np.linalg.norm(points[:, None] - points[None], axis=2)
        np.fill_diagonal(apart, np.inf)
        one, other = np.unravel_index(int(apart.argmin()), apart.shape)
        if apart[one, other] <= self.diameter_mm:
            raise ValueError(
                f"contacts {names[one]} and {names[other]} overlap: "
                f"{apart[one, other]:.3f} mm apart, diameter {self.diameter_mm:g} mm"
            )
        if self.capture_mm >= apart.min() / 2:
            raise ValueError("capture_mm reaches the next hole")
        reach = np.ptp(points, axis=0)
        if np.any(reach + self.diameter_mm > np.array(self.outline_mm)):
            raise ValueError("outline_mm is smaller than the contacts need")
        return self

    @model_validator(mode="after")
    def _depths_and_forces_are_in_order(self) -> Self:
        if self.force_n[0] >= self.force_n[1]:
            raise ValueError("force_n must be least and greatest force, in this order")
        if self.spring_depth_mm >= self.seat_depth_mm:
            raise ValueError("spring_depth_mm must be less than seat_depth_mm")
        if self.funnel_mm > self.spring_depth_mm:
            raise ValueError("funnel_mm must not exceed spring_depth_mm")
        if self.kind == "pins" and self.seat_depth_mm > self.length_mm:
            raise ValueError("seat_depth_mm is longer than the pins, length_mm")
        if self.kind == "holes" and self.chamfer_mm > 0:
            raise ValueError("chamfer_mm belongs to pins")
        if self.chamfer_mm >= self.diameter_mm / 2:
            raise ValueError("chamfer_mm leaves nothing of the tip")
        if self.true_position_mm >= self.capture_mm:
            raise ValueError("true_position_mm must be less than capture_mm")
        return self

    @model_validator(mode="after")
    def _symmetry_is_that_of_the_drawing(self) -> Self:
        # The positions decide. A wrong key would have a module plugged the wrong way round.
        apart_mm = asymmetry_m(self.points_mm(), HALF_TURN)
        looks_the_same = apart_mm < self.diameter_mm / 2
        if looks_the_same and not self.symmetric:
            raise ValueError(
                "symmetric = false, but half a turn lays all contacts on others; write true, and "
                "tell the two ways apart by marks or by the expected place"
            )
        if self.symmetric and not looks_the_same:
            raise ValueError(
                f"symmetric = true, but after half a turn a contact is {apart_mm:.3f} mm off"
            )
        return self

    def points_mm(self) -> Array:
        """Positions, shape (n, 2)."""
        return np.array([contact.position_mm for contact in self.contact])


def read_connector(path: Path) -> Connector:
    """Read a connector file; raises ``ConnectorFileInvalid`` with everything that is wrong."""
    return parse_connector(read_bytes(path, ConnectorFileInvalid), str(path))


def parse_connector(content: bytes, name: str) -> Connector:
    """The content of a connector file of that name; raises ``ConnectorFileInvalid``."""
    table = parse_toml(content, name, ConnectorTable, ConnectorFileInvalid)
    return Connector(
        name=table.name,
        kind=table.kind,
        contacts=tuple(contact.name for contact in table.contact),
        positions_m=table.points_mm() * MM,
        diameter_m=table.diameter_mm * MM,
        length_m=table.length_mm * MM,
        rim_depth_m=table.rim_depth_mm * MM,
        chamfer_m=table.chamfer_mm * MM,
        true_position_m=table.true_position_mm * MM,
        symmetric=table.symmetric,
        capture_m=table.capture_mm * MM,
        funnel_m=table.funnel_mm * MM,
        seat_depth_m=table.seat_depth_mm * MM,
        spring_depth_m=table.spring_depth_mm * MM,
        force_n=table.force_n,
        outline_m=(table.outline_mm[0] * MM, table.outline_mm[1] * MM),
        places_id=table.id_of(_PLACES),
    )


def least_spacing(points_m: Array) -> float:
    """Distance of the two points that are nearest to each other; ``points_m`` (n, 2)."""
    apart = np.linalg.norm(points_m[:, None] - points_m[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    return float(apart.min())
