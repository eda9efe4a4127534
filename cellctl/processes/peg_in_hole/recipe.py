"""One product of the process: a peg or a plug, its hole, and what it may feel like."""

from typing import Annotated, Literal

from pydantic import Field

from cellctl.config.base import LessSafe, Section, WrittenPose
from cellctl.config.recipe import Recipe
from cellctl.processes.peg_in_hole.plan.choice import SearchName

_Length = Annotated[float, Field(gt=0, le=500)]
_Chamfer = Annotated[float, Field(ge=0, le=20)]
_Force = Annotated[float, Field(gt=0, le=500)]
_Coordinate = Annotated[float, Field(ge=-1000, le=1000)]


class KeysSection(Section):
    """Keys of a plug by its drawing."""

    depth_mm: _Length
    """From the face to where the keys meet their keyways."""
    window_deg: Annotated[float, Field(gt=0, le=45)]
    """Half width of the angles that enter."""
    uncertainty_deg: Annotated[float, Field(gt=0, le=60), LessSafe.WITH_LESS]
    """The plug is turned by no more than this when it arrives, in 99 of 100 cases."""


class ContactsSection(Section):
    """Contacts or springs inside a plug, which hold it back on its way to the seat."""

    depth_mm: _Length
    """From the face to where they begin."""
    full_mm: _Length
    """From the face to where all of them rub."""
    least_n: _Force
    """Least force that they take from there to the seat, by good insertions."""
    most_n: _Force
    """Greatest force that they take, likewise."""


class Fit(Section):
    """Peg and hole by the drawing, mm."""

    peg_radius_mm: _Length
    clearance_mm: Annotated[float, Field(gt=0, le=5)]
    """Radius of the bore less that of the peg."""
    hole_chamfer_mm: _Chamfer = 0.0
    peg_chamfer_mm: _Chamfer = 0.0
    depth_mm: _Length
    """From the face to the seat."""
    outer_radius_mm: _Length | None = None
    """Of a raised plug that has the hole; left out for a hole in a plate."""
    friction: Annotated[float, Field(gt=0, lt=1)] = 0.2
    keys: KeysSection | None = None
    """Left out for a round part."""
    contacts: ContactsSection | None = None
    """Left out for a part that only friction holds back before its seat: any other force on the way
    counts as a part that slips in the gripper."""


class HolePlace(Section):
    """Where the hole is believed to be, and how far off it may be."""

    pose: WrittenPose
    """base_T_hole: the middle of the hole on its face, z out of it."""
    uncertainty_mm: Annotated[float, Field(gt=0, le=20), LessSafe.WITH_LESS]
    """Radius that holds 99 of 100 true places, along the face."""
    height_uncertainty_mm: Annotated[float, Field(gt=0, le=10), LessSafe.WITH_LESS]
    face_radius_mm: _Length
    """The face is touched on a circle of this radius: on the face, beside the hole."""
    datum_depth_mm: Annotated[float, Field(ge=0, le=100)] = 0.0
    """So much deeper than the face lies what is touched: the panel round a plug that stands proud
    of it. 0 touches the face itself."""
    taught_above_mm: Annotated[float, Field(gt=0, le=300)] | None = None
    """How high the tip stood over the face as ``above_hole`` was taught, by a rule."""


class Forces(Section):
    """What may be felt at the tip."""

    search_n: Annotated[_Force, LessSafe.WITH_MORE]
    """Pressed with while searching, and touched with."""
    insertion_n: Annotated[_Force, LessSafe.WITH_MORE]
    """Largest force of the insertion."""
    fault_n: Annotated[_Force, LessSafe.WITH_MORE]
    """The guard stops at it."""
    fault_nm: Annotated[float, Field(gt=0, le=100), LessSafe.WITH_MORE]
    """The same for moments, N·m: newton metres, as the columns of a curve are called, too."""
    withdrawal_n: _Force = 20.0
    """Largest force for drawing the part out again."""


class Seat(Section):
    """What a good part feels like at its seat."""

    least_n: _Force
    most_n: _Force
    grip_n: Annotated[float, Field(gt=0, le=5000), LessSafe.WITH_MORE] | None = None
    """Force along the axis at which the part slips in the gripper, measured at commissioning. Where
    it is left out, nothing is called inserted."""
    pull_n: Annotated[float, Field(gt=0, le=100)] | None = None
    """Pull that a part must hold which contacts or a lock keep; left out for one that lies free."""


class Load(Section):
    """What hangs behind the force sensor, by the drawing; a search tilts it."""

    mass_kg: Annotated[float, Field(gt=0, le=100)]
    com_in_sensor_mm: tuple[_Coordinate, _Coordinate, _Coordinate]


class PegRecipe(Recipe):
    """One part and its hole."""

    process: Literal["peg-in-hole"]
    fit: Fit
    base_T_hole: HolePlace
    flange_T_tip: WrittenPose
    """How the part is held: the middle of its foremost circle, z into the hole."""
    load: Load
    forces: Forces
    seat: Seat
    search: SearchName | None = None
    """Left out: what the figures of the task decide (docs/insertion-by-touch.md)."""
