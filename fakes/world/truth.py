"""The truth about the devices of a cell: everything that nobody in the cell knows exactly.

A hardware seed draws it from the scenario. What stands in the cell has a truth of its own, in the
scene.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import (
    Camera,
    ForceSensor,
    Optics,
    Robot,
    SingleCamera,
    Spread,
    StereoCamera,
    StereoRig,
    Tracker,
)
from fakes.world.arm import Links, perturbed_links
from fakes.world.frames import MM, Array, displacement, from_written, stream, stream_seed
from fakes.world.scene import LensTruth, MonoTruth, StereoTruth

_ASPECT_SPREAD = 5e-4
"""Half width of the relative difference between the focal lengths along x and y; assumed."""


@dataclass(frozen=True, slots=True)
class RobotTruth:
    """Where an arm stands in the cell and how it was built."""

    cell_T_base: RigidTransform
    links: Links


@dataclass(frozen=True, slots=True)
class CameraTruth:
    """A camera or stereo head as it was built and mounted."""

    mount_T_camera: RigidTransform
    """Pose on the flange of the robot that carries it, or in the cell where nothing does."""
    optics: StereoTruth | MonoTruth
    light_seed: int


@dataclass(frozen=True, slots=True, eq=False)
class ForceSensorTruth:
    """The force sensor: reading = matrix · load + offset + drift + noise."""

    flange_T_sensor: RigidTransform
    matrix: Array
    offset: Array
    drift_per_s: Array


@dataclass(frozen=True, slots=True, eq=False)
class TrackerTruth:
    """A tracker, and the targets at their real places on the flange that carries them."""

    cell_T_tracker: RigidTransform
    flange_targets_m: dict[str, Array]


@dataclass(frozen=True, slots=True)
class HardwareTruth:
    """Everything about the devices that stays the same for the whole life of a fake cell."""

    seed: int
    robots: dict[str, RobotTruth]
    cameras: dict[str, CameraTruth]
    """Stereo heads and single cameras."""
    force_sensors: dict[str, ForceSensorTruth]
    trackers: dict[str, TrackerTruth]


def draw(scenario: Scenario, seed: int) -> HardwareTruth:
    """The devices of a hardware seed; the same seed gives the same devices, bit by bit.

    So the order of the draws of one device may not change either: the calibrations that are shipped
    would be those of another cell (docs/decisions/0004).
    """
    sensors, trackers = scenario.force_sensors, scenario.trackers
    return HardwareTruth(
        seed=seed,
        robots={
            name: _robot(robot, stream(seed, "robot", name))
            for name, robot in scenario.robots.items()
        },
        cameras={
            name: _camera(scenario, camera, seed, name)
            for name, camera in scenario.all_cameras().items()
        },
        force_sensors={
            name: _force_sensor(sensor, stream(seed, "force sensor", *stream_keys(sensors, name)))
            for name, sensor in sensors.items()
        },
        trackers={
            name: _tracker(tracker, stream(seed, "large field", *stream_keys(trackers, name)))
            for name, tracker in trackers.items()
        },
    )


def stream_keys(devices: dict[str, ForceSensor] | dict[str, Tracker], name: str) -> tuple[str, ...]:
    """What tells the random streams of a device from those of others of its kind.

    The first of a kind has the stream of the kind alone: the calibrations that are shipped belong
    to devices that were drawn when a cell had one of each.
    """
    return () if name == next(iter(devices)) else (name,)


def drawn_spread(rng: np.random.Generator, spread: Spread) -> RigidTransform:
    """A displacement within the half widths: x, y, z first, then the rotation vector."""
    translation = rng.uniform(-1, 1, 3) * np.array(spread.xyz_mm) * MM
    rotation = rng.uniform(-1, 1, 3) * np.deg2rad(spread.rotation_deg)
    return displacement(translation, rotation)


def nominal_mount_T_camera(camera: Camera) -> RigidTransform:
    """Where the scenario file says that a camera is, on its flange or in the cell."""
    written = camera.flange_T_camera_mm_deg or camera.cell_T_camera_mm_deg
    assert written is not None  # the model of the section demands one of the two
    return from_written(written)


def _robot(robot: Robot, rng: np.random.Generator) -> RobotTruth:
    base = from_written(robot.base_mm_deg) * drawn_spread(rng, robot.base_placement)
    links = perturbed_links(
        robot.chain_mm,
        rng,
        robot.link_sigma_mm * MM,
        np.deg2rad(robot.link_sigma_deg),
        np.deg2rad(robot.joint_sigma_deg),
    )
    return RobotTruth(base, links)


def _camera(scenario: Scenario, camera: Camera, seed: int, name: str) -> CameraTruth:
    optics = scenario.optics[camera.optics]
    rig = optics.stereo if isinstance(camera, StereoCamera) else None
    rng = stream(seed, "head" if rig is not None else "camera", name)
    mount_T_camera = nominal_mount_T_camera(camera) * drawn_spread(rng, camera.mounting)
    drawn: StereoTruth | MonoTruth
    if rig is not None:
        drawn = _stereo(optics, rig, rng)
    else:
        colour = isinstance(camera, SingleCamera) and camera.colour
        drawn = MonoTruth(optics.image_px, _lens(optics, rng), colour)
    if waves_px := scenario.size_of("lens_misfit"):
        drawn = _with_misfit(drawn, waves_px / optics.focal_px, stream(seed, "lens misfit", name))
    return CameraTruth(mount_T_camera, drawn, stream_seed(seed, "light", name))


def _with_misfit(
    drawn: StereoTruth | MonoTruth, amplitude: float, rng: np.random.Generator
) -> StereoTruth | MonoTruth:
    """The same cameras behind lenses that the polynomial model does not fit."""

    def waved(lens: LensTruth) -> LensTruth:
        phase_x, phase_y = rng.uniform(0, 2 * np.pi, 2).tolist()
        return replace(lens, misfit=(amplitude, phase_x, phase_y))

    if isinstance(drawn, MonoTruth):
        return replace(drawn, lens=waved(drawn.lens))
    return replace(drawn, left=waved(drawn.left), right=waved(drawn.right))


def _stereo(optics: Optics, rig: StereoRig, rng: np.random.Generator) -> StereoTruth:
    """Left camera at the origin, right camera a baseline away and turned inwards about y."""
    left, right = _lens(optics, rng), _lens(optics, rng)
    baseline = rig.baseline_mm + rng.uniform(-1, 1) * rig.baseline_spread_mm
    half_deg = rig.toe_in_deg / 2
    wobble = Rotation.from_euler(
        "xyz", rng.uniform(-1, 1, 3) * rig.alignment_spread_deg, degrees=True
    )
    left_R_right = Rotation.from_euler("y", -2 * half_deg, degrees=True) * wobble
    direction = Rotation.from_euler("y", -half_deg, degrees=True).apply([1.0, 0.0, 0.0])
    left_T_right = RigidTransform.from_components(direction * baseline * MM, left_R_right)
    return StereoTruth(optics.image_px, left, right, left_T_right.inv())


def _lens(optics: Optics, rng: np.random.Generator) -> LensTruth:
    focal = optics.focal_px + rng.uniform(-1, 1) * optics.focal_spread_px
    aspect = 1 + rng.uniform(-1, 1) * _ASPECT_SPREAD
    centre = np.array(optics.centre_px) + rng.uniform(-1, 1, 2) * optics.centre_spread_px
    spread = rng.uniform(-1, 1, 5) * np.array(optics.distortion_spread)
    k1, k2, p1, p2, k3 = (np.array(optics.distortion) + spread).tolist()
    return LensTruth(
        focal_px=(float(focal), float(focal * aspect)),
        centre_px=(float(centre[0]), float(centre[1])),
        distortion=(k1, k2, p1, p2, k3),
        blur_px=float(optics.blur_px + rng.uniform(-1, 1) * optics.blur_spread_px),
        gain=float(1 + rng.uniform(-1, 1) * optics.gain_spread),
    )


def _force_sensor(sensor: ForceSensor, rng: np.random.Generator) -> ForceSensorTruth:
    mounting = displacement(np.zeros(3), np.deg2rad(rng.normal(0, sensor.mounting_sigma_deg, 3)))
    ranges = np.repeat([sensor.range_n, sensor.range_nm], 3)
    crosstalk = rng.normal(0, sensor.crosstalk_sigma, (6, 6)) * np.outer(ranges, 1 / ranges)
    np.fill_diagonal(crosstalk, rng.normal(0, sensor.gain_sigma, 6))
    offset = rng.normal(0, 1, 6) * np.repeat([sensor.offset_sigma_n, sensor.offset_sigma_nm], 3)
    per_minute = np.repeat([sensor.drift_n_per_min, sensor.drift_nm_per_min], 3)
    return ForceSensorTruth(
        flange_T_sensor=from_written(sensor.flange_T_sensor_mm_deg) * mounting,
        matrix=np.eye(6) + crosstalk,
        offset=offset,
        drift_per_s=rng.uniform(-1, 1, 6) * per_minute / 60,
    )


def _tracker(tracker: Tracker, rng: np.random.Generator) -> TrackerTruth:
    angles = np.deg2rad(60 * np.arange(6))
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(6)], axis=1)
    flange = ring * tracker.flange_ring_mm / 2 * MM
    flange = flange + rng.normal(0, tracker.target_sigma_mm * MM, flange.shape)
    cell_T_tracker = from_written(tracker.cell_T_tracker_mm_deg)
    return TrackerTruth(
        cell_T_tracker=cell_T_tracker * drawn_spread(rng, tracker.placement),
        flange_targets_m={f"F{index + 1}": place for index, place in enumerate(flange)},
    )
