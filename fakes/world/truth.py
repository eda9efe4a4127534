"""The truth that a seed draws from a scenario: everything that nobody in the cell knows exactly."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenario import Cameras, HeadName, HoleSpec, Parts, RobotName, Scenario, Spread
from fakes.world.arm import Links, perturbed_links
from fakes.world.frames import MM, Array, displacement, from_written, stream, stream_seed
from fakes.world.scene import HoleKind, LensTruth, SceneDisc, SceneHole, StereoTruth


@dataclass(frozen=True, slots=True)
class RobotTruth:
    """Where an arm stands in the cell (the base of the main robot) and how it was built."""

    cell_T_base: RigidTransform
    links: Links


@dataclass(frozen=True, slots=True)
class HeadTruth:
    """A small-field head."""

    flange_T_head: RigidTransform
    stereo: StereoTruth
    light_seed: int


@dataclass(frozen=True, slots=True)
class SensorTruth:
    """The force sensor: reading = matrix · load + offset + drift + noise."""

    flange_T_sensor: RigidTransform
    matrix: Array
    offset: Array
    drift_per_s: Array


@dataclass(frozen=True, slots=True)
class LargeFieldTruth:
    """The head above the cell; targets at their real places on flange and board."""

    cell_T_head: RigidTransform
    flange_targets_m: dict[str, Array]
    board_targets_m: dict[str, Array]


@dataclass(frozen=True, slots=True)
class PartsTruth:
    """One pair of frame and deck, as loaded by the operator."""

    number: int
    cell_T_frame: RigidTransform
    flange_T_deck: RigidTransform
    deck_thickness_m: float
    frame_holes: tuple[SceneHole, ...]
    deck_holes: tuple[SceneHole, ...]
    contact_stiffness_n_m: float
    frame_seed: int
    deck_seed: int


@dataclass(frozen=True, slots=True)
class WorldTruth:
    """Everything that stays the same for the whole life of a fake cell."""

    hardware_seed: int
    robots: dict[RobotName, RobotTruth]
    heads: dict[HeadName, HeadTruth]
    sensor: SensorTruth
    large_field: LargeFieldTruth
    chessboard_bow_m: tuple[float, float]


def draw(scenario: Scenario, seed: int) -> WorldTruth:
    """The devices of a hardware seed; the same seed gives the same devices, bit by bit."""
    rng = stream(seed, "chessboard")
    bow_x, bow_y = rng.uniform(-1, 1, 2) * scenario.chessboard.bow_spread_mm * MM
    return WorldTruth(
        hardware_seed=seed,
        robots={name: _robot(scenario, seed, name) for name in scenario.robots},
        heads={name: _head(scenario, seed, name) for name in scenario.heads},
        sensor=_sensor(scenario, seed),
        large_field=_large_field(scenario, seed),
        chessboard_bow_m=(float(bow_x), float(bow_y)),
    )


def draw_parts(scenario: Scenario, seed: int, number: int) -> PartsTruth:
    """The ``number``-th pair of parts of a cell."""
    parts = scenario.parts
    rng = stream(seed, "parts", number)
    low, high = np.log(scenario.contact.stiffness_n_m)
    thickness_spread = parts.deck_thickness_spread_mm
    return PartsTruth(
        number=number,
        cell_T_frame=from_written(parts.frame_mm_deg) * _spread(rng, parts.frame_displacement),
        flange_T_deck=from_written(parts.flange_T_deck_mm_deg) * _spread(rng, parts.grip),
        deck_thickness_m=(
            parts.deck_thickness_mm + rng.uniform(-thickness_spread, thickness_spread)
        )
        * MM,
        contact_stiffness_n_m=float(np.exp(rng.uniform(low, high))),
        frame_holes=tuple(_frame_hole(parts, hole, rng) for hole in parts.holes),
        deck_holes=tuple(_deck_hole(parts, hole, rng) for hole in parts.holes),
        frame_seed=stream_seed(seed, "frame texture", number),
        deck_seed=stream_seed(seed, "deck texture", number),
    )


def _spread(rng: np.random.Generator, spread: Spread) -> RigidTransform:
    translation = rng.uniform(-1, 1, 3) * np.array(spread.xyz_mm) * MM
    rotation = rng.uniform(-1, 1, 3) * np.deg2rad(spread.rotation_deg)
    return displacement(translation, rotation)


def _robot(scenario: Scenario, seed: int, name: RobotName) -> RobotTruth:
    robot = scenario.robots[name]
    rng = stream(seed, "robot", name)
    base = from_written(robot.base_mm_deg) * _spread(rng, robot.base_placement)
    links = perturbed_links(
        robot.chain_mm,
        rng,
        robot.link_sigma_mm * MM,
        np.deg2rad(robot.link_sigma_deg),
        np.deg2rad(robot.joint_sigma_deg),
    )
    return RobotTruth(base, links)


def _head(scenario: Scenario, seed: int, name: HeadName) -> HeadTruth:
    head = scenario.heads[name]
    rng = stream(seed, "head", name)
    flange_T_head = from_written(head.flange_T_head_mm_deg) * _spread(rng, head.mounting)
    return HeadTruth(
        flange_T_head, _stereo(scenario.cameras, rng), stream_seed(seed, "light", name)
    )


def _stereo(cameras: Cameras, rng: np.random.Generator) -> StereoTruth:
    """Left camera at the origin, right camera a baseline away and turned inwards about y."""
    left, right = _lens(cameras, rng), _lens(cameras, rng)
    baseline = cameras.baseline_mm + rng.uniform(-1, 1) * cameras.baseline_spread_mm
    half_deg = cameras.toe_in_deg / 2
    wobble = Rotation.from_euler(
        "xyz", rng.uniform(-1, 1, 3) * cameras.alignment_spread_deg, degrees=True
    )
    left_R_right = Rotation.from_euler("y", -2 * half_deg, degrees=True) * wobble
    direction = Rotation.from_euler("y", -half_deg, degrees=True).apply([1.0, 0.0, 0.0])
    left_T_right = RigidTransform.from_components(direction * baseline * MM, left_R_right)
    return StereoTruth(cameras.image_px, left, right, left_T_right.inv())


def _lens(cameras: Cameras, rng: np.random.Generator) -> LensTruth:
    focal = cameras.focal_px + rng.uniform(-1, 1) * cameras.focal_spread_px
    aspect = 1 + rng.uniform(-1, 1) * 5e-4
    centre = np.array(cameras.centre_px) + rng.uniform(-1, 1, 2) * cameras.centre_spread_px
    spread = rng.uniform(-1, 1, 5) * np.array(cameras.distortion_spread)
    k1, k2, p1, p2, k3 = (np.array(cameras.distortion) + spread).tolist()
    return LensTruth(
        focal_px=(float(focal), float(focal * aspect)),
        centre_px=(float(centre[0]), float(centre[1])),
        distortion=(k1, k2, p1, p2, k3),
        blur_px=float(cameras.blur_px + rng.uniform(-1, 1) * cameras.blur_spread_px),
        gain=float(1 + rng.uniform(-1, 1) * cameras.gain_spread),
    )


def _sensor(scenario: Scenario, seed: int) -> SensorTruth:
    sensor = scenario.force_sensor
    rng = stream(seed, "force sensor")
    mounting = displacement(np.zeros(3), np.deg2rad(rng.normal(0, sensor.mounting_sigma_deg, 3)))
    ranges = np.repeat([sensor.range_n, sensor.range_nm], 3)
    crosstalk = rng.normal(0, sensor.crosstalk_sigma, (6, 6)) * np.outer(ranges, 1 / ranges)
    np.fill_diagonal(crosstalk, rng.normal(0, sensor.gain_sigma, 6))
    offset = rng.normal(0, 1, 6) * np.repeat([sensor.offset_sigma_n, sensor.offset_sigma_nm], 3)
    per_minute = np.repeat([sensor.drift_n_per_min, sensor.drift_nm_per_min], 3)
    return SensorTruth(
        flange_T_sensor=from_written(sensor.flange_T_sensor_mm_deg) * mounting,
        matrix=np.eye(6) + crosstalk,
        offset=offset,
        drift_per_s=rng.uniform(-1, 1, 6) * per_minute / 60,
    )


def _large_field(scenario: Scenario, seed: int) -> LargeFieldTruth:
    field = scenario.large_field
    rng = stream(seed, "large field")
    angles = np.deg2rad(60 * np.arange(6))
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(6)], axis=1)
    flange = ring * field.flange_ring_mm / 2 * MM
    flange = flange + rng.normal(0, field.target_sigma_mm * MM, flange.shape)
    return LargeFieldTruth(
        cell_T_head=from_written(field.base_T_head_mm_deg) * _spread(rng, field.placement),
        flange_targets_m={f"F{index + 1}": place for index, place in enumerate(flange)},
        board_targets_m={
            disc.name: np.array([*disc.position_m, 0.0]) for disc in board_discs(scenario)
        },
    )


def board_discs(scenario: Scenario) -> tuple[SceneDisc, ...]:
    """P1 to P9, row by row: x right, y down the rows, P5 in the middle."""
    pitch_x, pitch_y = np.array(scenario.target_board.pitch_mm) * MM
    return tuple(
        SceneDisc(f"P{3 * row + column + 1}", ((column - 1) * pitch_x, (row - 1) * pitch_y))
        for row in range(3)
        for column in range(3)
    )


def _frame_hole(parts: Parts, hole: HoleSpec, rng: np.random.Generator) -> SceneHole:
    diameter = parts.pin_diameter_mm if hole.pin else parts.thread_diameter_mm
    place = _machined(parts, hole, rng)
    kind: HoleKind = "pin" if hole.pin else "thread"
    depth = parts.frame_depth_mm * MM
    return SceneHole(hole.name, kind, place, diameter * MM, None, depth, through=hole.pin)


def _deck_hole(parts: Parts, hole: HoleSpec, rng: np.random.Generator) -> SceneHole:
    place = _machined(parts, hole, rng)
    depth = parts.deck_thickness_mm * MM
    if hole.pin:
        return SceneHole(
            hole.name, "pin", place, parts.pin_diameter_mm * MM, None, depth, through=True
        )
    return SceneHole(
        hole.name,
        "countersink",
        place,
        parts.bore_diameter_mm * MM,
        parts.countersink_mm * MM,
        depth,
        through=True,
    )


def _machined(parts: Parts, hole: HoleSpec, rng: np.random.Generator) -> tuple[float, float]:
    place = (np.array(hole.position_mm) + rng.normal(0, parts.hole_sigma_mm, 2)) * MM
    return float(place[0]), float(place[1])
