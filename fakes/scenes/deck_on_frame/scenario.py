"""Sections that a scenario of a deck on its frame has beside those of its devices."""

from typing import Any, Self

from pydantic import model_validator

from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import (
    ChessboardPrint,
    DeviceName,
    Pair,
    Pose,
    Section,
    Spread,
    Springs,
    Three,
)


class HoleSpec(Section):
    """A pair of holes of the same place: on the frame and on the deck."""

    name: str
    position_mm: Pair
    pin: bool


class Parts(Section):
    """Frame and deck."""

    loaded_at_start: bool
    size_mm: Pair
    deck_thickness_mm: float
    deck_thickness_spread_mm: float
    frame_mm_deg: Pose
    frame_displacement: Spread
    flange_T_deck_mm_deg: Pose
    grip: Spread
    hole_sigma_mm: float
    """Machining error of a hole's position, each coordinate."""
    holes: tuple[HoleSpec, ...]
    pin_diameter_mm: float
    thread_diameter_mm: float
    bore_diameter_mm: float
    countersink_mm: float
    frame_depth_mm: float
    seen_by: dict[DeviceName, tuple[str, str, str]]
    """Holes that each stereo head measures, by name."""


class DeckPayload(Springs):
    """Gripper, fixture and deck behind the sensor; its axes are those of the deck."""

    behind: DeviceName
    """The force sensor that the gripper is mounted on."""
    gripper_kg: float
    deck_kg: float
    com_in_sensor_mm: Three
    gripper_com_in_sensor_mm: Three
    """Centre of mass of the gripper without the deck."""


class Pins(Section):
    """Dowels in the frame for the pin holes of the deck."""

    length_mm: float
    """Above the mating face, chamfer included."""
    radius_mm: float
    clearance_mm: float
    """Radial."""
    chamfer_mm: float
    """Length along the axis, pin and hole together."""
    chamfer_deg: float
    """Angle of the chamfer to the axis."""
    stiffness_n_m: float


class Contact(Section):
    """Rim of the deck on the frame."""

    stiffness_n_m: Pair
    """Range, drawn log-uniformly; all pads together."""
    damping_ratio: float
    friction: float
    pads: int
    rim_inset_mm: float
    pins: Pins | None = None
    """None for the way of the paper: no pins while mating, the holes are gauged afterwards."""


class TargetBoard(Section):
    """Board P with white discs."""

    size_mm: Pair
    disc_diameter_mm: float
    pitch_mm: Pair
    height_mm: float
    """Height of its face above the mating face of the frame."""
    placement: Spread


class Chessboard(ChessboardPrint):
    """Chessboard that is held under a head by hand."""

    distance_mm: Pair
    """Distance from the middle between the cameras."""
    offset_mm: Pair
    tilt_deg: float
    turn_rad: float


class DeckScenario(Scenario):
    """The whole file. The frame of the cell is the base of the robot that carries the deck."""

    parts: Parts
    payload: DeckPayload
    contact: Contact
    target_board: TargetBoard
    chessboard: Chessboard

    def nominal_poses(self) -> dict[str, Any]:
        """Deck in the gripper, frame in the cell."""
        return {
            "flange_T_deck_mm_deg": list(self.parts.flange_T_deck_mm_deg),
            "base_T_frame_mm_deg": list(self.parts.frame_mm_deg),
        }

    @property
    def deck_robot(self) -> DeviceName:
        """The robot that carries the deck."""
        return self.force_sensors[self.payload.behind].mounted_on

    @model_validator(mode="after")
    def _devices_of_the_scene(self) -> Self:
        if self.payload.behind not in self.force_sensors:
            raise ValueError(f"payload.behind: there is no force sensor {self.payload.behind!r}")
        if len(self.stereo_cameras) != 2 or set(self.parts.seen_by) != set(self.stereo_cameras):
            raise ValueError("the deck is measured by two stereo cameras, each in parts.seen_by")
        if any(head.carried_by is None for head in self.stereo_cameras.values()):
            raise ValueError("robots carry the stereo cameras over the deck")
        if len(self.trackers) != 1:
            raise ValueError("one tracker measures the targets of flange and board")
        return self
