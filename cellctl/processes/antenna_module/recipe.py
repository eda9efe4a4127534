"""One product of the process: a module with its plug, and the socket that it goes into."""

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from cellctl.config.base import Section, WrittenPose
from cellctl.config.recipe import Recipe

Length = Annotated[float, Field(gt=0, le=1000)]


class Place(Section):
    """Where something lies by the drawing, and how far off it may be."""

    pose: WrittenPose
    """In the frame that the key names."""
    within_mm: Annotated[float, Field(gt=0, le=20)] = 2.0
    within_deg: Annotated[float, Field(gt=0, le=10)] = 2.0
    height_sigma_mm: Annotated[float, Field(gt=0, le=1)] = 0.05
    """How certain its height is: one image does not measure it. From the mechanics that carry it;
    standard deviation."""
    tilt_sigma_deg: Annotated[float, Field(gt=0, le=1)] = 0.1


class TaughtPlace(Place):
    """A place over which a pose was taught, so that one can be held against the other."""

    taught_above_mm: Annotated[float, Field(gt=0, le=300)] | None = None
    """How high the plug stood over this place as ``above_tray`` or ``above_socket`` was taught, by
    a rule: from the face of the socket, or from where the plug lies on the tray."""


class Insertion(Section):
    """From the stand-off into the socket, and out of it where that fails."""

    stand_off_mm: Annotated[float, Field(ge=1, le=20)] = 3.0
    """Tips over the socket's face."""
    step_mm: Annotated[float, Field(ge=0.02, le=0.1)] = 0.1
    """Length of one guarded move. A single pin that stands on the face meets 11.5 N in 0.1 mm even
    if no stop were obeyed."""
    height_sigmas: Annotated[float, Field(ge=1, le=5)] = 2.0
    """Touch and contact springs may come earlier than drawn by so many standard deviations of the
    heights of plug and socket."""
    pull_n: Annotated[float, Field(gt=0, le=20)] = 2.0
    """Test after the seat: less than the least force that holds a good plug. Micro-D contacts to
    MIL-DTL-83513 hold with 0.2 N at least, fifteen of them with 3 N."""
    pull_travel_mm: Annotated[float, Field(gt=0, le=1)] = 0.2
    """A plug that comes so far before it resists is not held."""
    seat_tolerance_mm: Annotated[float, Field(gt=0, le=1)] = 0.15
    retreat_mm: Annotated[float, Field(ge=5, le=100)] = 30.0
    """Straight up after release, before anything else moves."""


class AntennaRecipe(Recipe):
    """One module and its socket."""

    process: Literal["antenna-module"]
    plug: str
    """Drawing of the module's connector, relative to the cell file."""
    socket: str
    """Drawing of the connector that it goes into."""
    gripper_marks: str
    """Drawing of the marks on the gripper."""
    module_top: str
    """Drawing of the marks on top of the module, which camera I sees on the tray."""
    scheme: Literal["difference", "golden", "absolute"] = "difference"
    """How the plug's place is found: docs/plugging.md."""
    worst_contact_mm: Annotated[float, Field(gt=0, le=1)] = 0.05
    """The predicted 99th percentile of the worst contact's offset may be this: the tolerance of the
    fit that the paper states."""
    base_T_tray_plug: TaughtPlace
    """The plug of a module on the tray."""
    base_T_socket: TaughtPlace
    flange_T_plug: WrittenPose
    """How the gripper holds the plug."""
    flange_T_marks: WrittenPose
    plug_height_sigma_mm: Annotated[float, Field(gt=0, le=1)] = 0.05
    """Of the plug in the gripper, as ``Place.height_sigma_mm``."""
    plug_T_top: WrittenPose
    """The marks on top, seen from the plug."""
    module_mass_kg: Annotated[float, Field(gt=0, le=20)]
    mass_tolerance_ratio: Annotated[float, Field(gt=0, le=0.5)] = 0.05
    grip_approach_mm: Annotated[float, Field(ge=10, le=200)] = 60.0
    """The fingers come down onto the module from so high."""
    frames: Annotated[int, Field(ge=1, le=20)] = 3
    """Images of one look."""
    socket_looks: Annotated[int, Field(ge=1, le=10)] = 2
    """Approaches from which the socket is looked at."""
    max_age_s: Annotated[float, Field(gt=0, le=600)] = 60.0
    """Of a look when the plug goes in."""
    seated_limit_mm: Annotated[float, Field(gt=0, le=5)] = 0.1
    """How far the module may stand from its place after release, sideways."""
    seated_limit_deg: Annotated[float, Field(gt=0, le=5)] = 0.5
    """How far it may be turned there about the axis of the socket."""
    gap_limit_mm: Annotated[float, Field(gt=0, le=1)] = 0.1
    """How far it may have come up from where it was felt to sit."""
    gap_zero_mm: Annotated[float, Field(ge=-0.5, le=0.5)] = 0.0
    """What the gap reads for a module that sits: errors of the arm between tray and socket, alike
    for every module. From the records of good ones."""
    insertion: Insertion = Insertion()

    def files(self) -> Mapping[str, str]:
        """The drawings."""
        return {
            "plug.toml": self.plug,
            "socket.toml": self.socket,
            "gripper_marks.toml": self.gripper_marks,
            "module_top.toml": self.module_top,
        }
