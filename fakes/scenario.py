"""The scenario file of the fake cell: every figure of the world, in mm, degrees, ms, N.

A ``*_spread`` is the half width of a uniform draw, a ``*_sigma`` the standard deviation of a normal
draw; ``fakes.world.truth.draw`` makes the draws.
"""

import tomllib
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict

Pose = tuple[float, float, float, float, float, float]
"""x, y, z in mm and A, B, C in degrees with R = Rz(A) Ry(B) Rx(C)."""
RobotName = Literal["main", "aux_1", "aux_2"]
HeadName = Literal["head_1", "head_2"]
Channel = Literal["CMD", "STA", "GRD"]
Six = tuple[float, float, float, float, float, float]
Pair = tuple[float, float]


class Section(BaseModel):
    """A part of the scenario file: no unknown keys, no changes afterwards."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Chain(Section):
    """Nominal links of a 6R arm with a spherical wrist. Stand-ins, not SIASUN data."""

    d1: float
    a1: float
    a2: float
    elbow: float
    d4: float
    d6: float


class Spread(Section):
    """Uniform half widths of a displaced body: along x, y, z and about x, y, z."""

    xyz_mm: tuple[float, float, float]
    rotation_deg: tuple[float, float, float]


class Robot(Section):
    """An arm and its controller."""

    name: str
    ports: dict[Channel, int]
    chain_mm: Chain
    limits_deg: tuple[Pair, Pair, Pair, Pair, Pair, Pair]
    rated_deg_s: Six
    base_mm_deg: Pose
    base_placement: Spread
    link_sigma_mm: float
    link_sigma_deg: float
    joint_sigma_deg: float
    repeatability_mm: float
    """Three standard deviations of each coordinate."""
    repeatability_deg: float
    correlation_mm: float
    """Travel after which the repeatability error is mostly a new one."""
    settling_mm: float
    """Standard deviation of what every single motion adds, however short it is."""
    settling_deg: float
    start_latency_ms: float
    stop_latency_ms: float
    stop_deceleration_mm_s2: float
    ramp_s: float
    """Time to the rated speed of a joint."""
    speed_max_mm_s: float
    step_max_mm: float
    deadman_ms: int
    home_deg: Six
    """Joint angles at switch-on."""


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


class Payload(Section):
    """Gripper, fixture and deck behind the sensor."""

    gripper_kg: float
    deck_kg: float
    com_in_sensor_mm: tuple[float, float, float]
    gripper_com_in_sensor_mm: tuple[float, float, float]
    """Without the deck."""
    inertia_kg_m2: tuple[float, float, float]
    """About the centre of mass, gripper, fixture and deck together."""
    stiffness_n_m: tuple[float, float, float]
    """Robot and gripper in series, deck axes."""
    rotational_stiffness_nm_rad: tuple[float, float, float]
    damping_ratio: float


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
    """Against the axis."""
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
    """None as in the paper: no pins while mating, the holes are gauged afterwards."""


class ForceSensor(Section):
    """Six-axis sensor between flange and gripper."""

    flange_T_sensor_mm_deg: Pose
    mounting_sigma_deg: float
    range_n: float
    range_nm: float
    noise_n: float
    noise_nm: float
    vibration_n: float
    vibration_hz: float
    gain_sigma: float
    crosstalk_sigma: float
    offset_sigma_n: float
    offset_sigma_nm: float
    drift_n_per_min: float
    drift_nm_per_min: float


class Head(Section):
    """A small-field head on an auxiliary robot."""

    serial: str
    port: int
    robot: RobotName
    flange_T_head_mm_deg: Pose
    mounting: Spread
    sees: tuple[str, str, str]


class Cameras(Section):
    """Lens models; the same nominal figures for all four cameras."""

    image_px: tuple[int, int]
    focal_px: float
    focal_spread_px: float
    centre_px: Pair
    centre_spread_px: float
    distortion: tuple[float, float, float, float, float]
    distortion_spread: tuple[float, float, float, float, float]
    baseline_mm: float
    baseline_spread_mm: float
    toe_in_deg: float
    alignment_spread_deg: float
    blur_px: float
    blur_spread_px: float
    gain_spread: float
    exposure_us: int


class Rendering(Section):
    """Appearance; levels are grey values 0 to 255."""

    plate_level: float
    background_level: float
    hole_level: float
    wall_visibility: float
    """Brightness of a hole's wall, 0 as dark as the hole, 1 as bright as the plate."""
    countersink_levels: Pair
    """Darkest and brightest azimuth, relative to the plate."""
    thread_levels: Pair
    light_gradient: float
    """Relative change of light from one side of the image to the other."""
    texture_levels: float
    read_noise_levels: float
    electrons_per_level: float
    """Sets the shot noise."""
    scratches: int
    false_circles: int
    board_dark_level: float
    board_bright_level: float


class TargetBoard(Section):
    """Board P with white discs."""

    size_mm: Pair
    disc_diameter_mm: float
    pitch_mm: Pair
    height_mm: float
    """Above the mating face of the frame."""
    placement: Spread


class Chessboard(Section):
    """Chessboard that is held under a head by hand."""

    inner_corners: tuple[int, int]
    square_mm: float
    size_mm: Pair
    bow_spread_mm: float
    distance_mm: Pair
    """From the middle between the cameras."""
    offset_mm: Pair
    tilt_deg: float
    turn_rad: float


class LargeField(Section):
    """Head that measures targets, above the cell."""

    serial: str
    port: int
    base_T_head_mm_deg: Pose
    placement: Spread
    noise_mm: float
    target_sigma_mm: float
    """Mounting error of each target, constant."""
    flange_ring_mm: float
    range_mm: Pair
    half_angle_deg: float
    tilt_max_deg: float
    frame_time_ms: float


class Scenario(Section):
    """The whole file."""

    hardware_seed: int
    """Draws the devices of the cell, which calibrations belong to."""
    sensor_port: int
    control_port: int
    robots: dict[RobotName, Robot]
    parts: Parts
    payload: Payload
    contact: Contact
    force_sensor: ForceSensor
    heads: dict[HeadName, Head]
    cameras: Cameras
    rendering: Rendering
    target_board: TargetBoard
    chessboard: Chessboard
    large_field: LargeField
    taught: dict[RobotName, dict[str, Pose]]
    """Flange poses in the base of the main robot, by robot and name."""


def load(path: Path) -> Scenario:
    """Read a scenario file; raises ``pydantic.ValidationError`` or ``tomllib.TOMLDecodeError``."""
    with path.open("rb") as file:
        return Scenario.model_validate(tomllib.load(file))
