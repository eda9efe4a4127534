"""Reference checks in drawn cells of which one device was moved."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.antenna.chain.drawn_cell import (
    CONTACT_PX,
    FLANGE_T_PLUG,
    MARKS_M,
    PLUG_STATION,
    SOCKET,
    DrawnCell,
    base_T_flange_over_socket,
)
from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.reference_check import (
    ReferenceReading,
    require_reference,
)
from cellctl.processes.antenna_module.chain.tool_turn import TurnStop, calibrate_tool_turn
from cellctl.processes.antenna_module.faults.calibration import (
    FixedCameraMoved,
    GripperMarksMoved,
    ReferenceMoved,
    ReferencePlateMoved,
)

ANGLES = 8
PLATE_LOOKS = 8
MOVED_M = 20e-6


@dataclass(frozen=True, slots=True)
class ReferenceCounts:
    """How checks ended."""

    checks: int
    named: int
    """With the right device moved by 20 µm."""
    found: int
    """With any device named."""
    false: int
    """Of as many checks in which nothing was moved."""


def count_reference_checks(
    cell: DrawnCell, rng: np.random.Generator, rounds: int
) -> ReferenceCounts:
    """Every device moved in turn, and as many checks with nothing moved."""
    taught = read_reference(cell, rng, repeats=4)
    named = found = false = 0
    faults = (FixedCameraMoved, GripperMarksMoved, ReferencePlateMoved)
    for _ in range(rounds):
        for fault in faults:
            seen = _check(taught, read_reference(_moved(cell, fault, rng), rng))
            named += seen is fault
            found += seen is not None
            false += _check(taught, read_reference(cell, rng)) is not None
    return ReferenceCounts(rounds * len(faults), named, found, false)


def read_reference(cell: DrawnCell, rng: np.random.Generator, repeats: int = 1) -> ReferenceReading:
    """One check, or the mean of several as it is taught."""
    each = np.mean([_places(cell, rng) for _ in range(repeats)], axis=0)
    noise = cell.arm.repeatability.position_m
    sigma_m = noise * np.sqrt(1.5 / ANGLES / repeats)
    return ReferenceReading(each[0], each[1], each[2], each[3], float(sigma_m))


def _check(taught: ReferenceReading, now: ReferenceReading) -> type[ReferenceMoved] | None:
    try:
        require_reference(taught, now)
    except ReferenceMoved as fault:
        return type(fault)
    return None


def _places(cell: DrawnCell, rng: np.random.Generator) -> Array:
    """The four places in the axes of the base, shape (4, 2)."""
    base_R_cam2 = cell.base_T_cam2.pose.rotation
    stops = []
    for angle in 2 * np.pi * np.arange(ANGLES) / ANGLES:
        place = cell.arm.turned(PLUG_STATION * FLANGE_T_PLUG.inv(), float(angle), rng)
        marks = cell.mounting.base_T_cam2.inv() * place * cell.mounting.flange_T_marks
        seen = cell.optics2.look(marks, MARKS_M, cell.cam2_T_plane(2), CONTACT_PX, rng)
        stops.append(TurnStop(float(angle), base_R_cam2.apply(seen.pose.translation)[:2]))
    turned = calibrate_tool_turn(stops)
    commanded = PLUG_STATION * SOCKET.inv() * base_T_flange_over_socket()
    by_1 = np.mean([_plate_in_camera_1(cell, commanded, rng) for _ in range(PLATE_LOOKS)], axis=0)
    plate = cell.mounting.base_T_cam2.inv() * cell.mounting.base_T_plate
    by_2 = cell.optics2.look(plate, MARKS_M, cell.cam2_T_plane(), CONTACT_PX, rng)
    in_2 = base_R_cam2.apply(by_2.pose.translation)[:2]
    return np.stack([turned.axis_m, turned.offset_m, by_1, in_2])


def _plate_in_camera_1(
    cell: DrawnCell, commanded: RigidTransform, rng: np.random.Generator
) -> Array:
    base_T_cam1 = cell.arm.place(commanded, rng) * cell.mounting.flange_T_cam1
    plate = base_T_cam1.inv() * cell.mounting.base_T_plate
    seen = cell.optics1.look(plate, MARKS_M, cell.cam1_T_plane, CONTACT_PX, rng)
    base_R_cam1 = (commanded * cell.flange_T_cam1.pose).rotation
    return np.asarray(base_R_cam1.apply(seen.pose.translation)[:2])


def _moved(cell: DrawnCell, fault: type[ReferenceMoved], rng: np.random.Generator) -> DrawnCell:
    direction = rng.uniform(0, 2 * np.pi)
    shift = RigidTransform.from_translation(
        [MOVED_M * np.cos(direction), MOVED_M * np.sin(direction), 0.0]
    )
    mounting = cell.mounting
    if fault is FixedCameraMoved:
        mounting = replace(mounting, base_T_cam2=shift * mounting.base_T_cam2)
    elif fault is GripperMarksMoved:
        mounting = replace(mounting, flange_T_marks=shift * mounting.flange_T_marks)
    else:
        mounting = replace(mounting, base_T_plate=shift * mounting.base_T_plate)
    return replace(cell, mounting=mounting)
