"""Reference checks in drawn cells of which one device was moved."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.antenna.chain.drawn_cell import (
    CONTACT_PX,
    FLANGE_T_PLUG,
    LEVER_M,
    MARKS_M,
    PLATE_M,
    PLUG_STATION,
    SOCKET,
    DrawnCell,
    base_T_flange_over_socket,
)
from benchmarks.antenna.chain.optics import Sight
from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.cell_figures import ArmFigures
from cellctl.processes.antenna_module.chain.reference.reference_check import (
    ReferenceReading,
    further_looks,
    require_nothing_moved,
)
from cellctl.processes.antenna_module.chain.reference.reference_looks import (
    ReferenceLooks,
    turn_angles,
)
from cellctl.processes.antenna_module.chain.teaching.tool_turn import TurnStop
from cellctl.processes.antenna_module.faults.calibration import (
    FixedCameraMoved,
    FlangeCameraMoved,
    GripperMarksMoved,
    ReferenceMoved,
    ReferencePlateMoved,
)

LOOKS, TAUGHT_LOOKS = 4, 16
"""Numbers of looks that hold where a cell file says nothing else."""
MOVED_M = 20e-6
DRIFT_M = 24e-6
"""What the cell file states of an arm that warms up by 3 K: it is not found by the check."""
_FAULTS = (FixedCameraMoved, FlangeCameraMoved, GripperMarksMoved, ReferencePlateMoved)


@dataclass(frozen=True, slots=True)
class ReferenceCounts:
    """How checks ended."""

    checks: int
    named: int
    """Checks that named the right device, which was moved by 20 µm."""
    found: int
    """Checks that named some device."""
    false: int
    """Checks that named a device though nothing was moved, of as many checks."""
    looks: int
    """That all checks took together."""


def count_reference_checks(
    cell: DrawnCell, absolute_error_m: float, rng: np.random.Generator, rounds: int
) -> ReferenceCounts:
    """Every device moved in turn, and as many checks with nothing moved, as step 10 makes them."""
    noise = cell.arm.repeatability
    arm = ArmFigures(noise.position_m, noise.rotation_rad, absolute_error_m, DRIFT_M)
    taught = _look(cell, rng, TAUGHT_LOOKS).reading(arm)
    named = found = false = looks = 0
    for _ in range(rounds):
        for fault in _FAULTS:
            seen, taken = _check(taught, _moved(cell, fault, rng), arm, rng)
            named += seen is fault
            found += seen is not None
            nothing, again = _check(taught, cell, arm, rng)
            false += nothing is not None
            looks += taken + again
    return ReferenceCounts(rounds * len(_FAULTS), named, found, false, looks)


def _check(
    taught: ReferenceReading, cell: DrawnCell, arm: ArmFigures, rng: np.random.Generator
) -> tuple[type[ReferenceMoved] | None, int]:
    """The fault, and how many looks the check took."""
    looks = _look(cell, rng, LOOKS)
    while more := further_looks(taught, looks.reading(arm), first=LOOKS, taken=len(looks.turns)):
        looks += _look(cell, rng, more)
    try:
        require_nothing_moved(taught, looks.reading(arm), arm.drift_m)
    except ReferenceMoved as fault:
        return type(fault), len(looks.turns)
    return None, len(looks.turns)


def _look(cell: DrawnCell, rng: np.random.Generator, count: int) -> ReferenceLooks:
    """The drive past marks and plate, each look with an approach of its own."""
    return ReferenceLooks(
        tuple(_marks_in_camera_2(cell, angle, rng) for angle in turn_angles(count)),
        tuple(_plate_in_camera_1(cell, rng) for _ in range(count)),
        (_plate_in_camera_2(cell, rng),),
        LEVER_M,
    )


def _marks_in_camera_2(cell: DrawnCell, angle_rad: float, rng: np.random.Generator) -> TurnStop:
    """Marks less the flange axis, which stays where it is commanded while joint 6 turns."""
    commanded = PLUG_STATION * FLANGE_T_PLUG.inv()
    base_T_marks = cell.arm.turned(commanded, angle_rad, rng) * cell.mounting.flange_T_marks
    cam2_T_marks = cell.mounting.base_T_cam2.inv() * base_T_marks
    seen = cell.optics2.look(Sight(cam2_T_marks, MARKS_M, cell.cam2_T_plane(2), CONTACT_PX), rng)
    place_m = (cell.base_T_cam2.pose * seen.pose).translation - commanded.translation
    return TurnStop(angle_rad, place_m[:2])


def _plate_in_camera_2(cell: DrawnCell, rng: np.random.Generator) -> Array:
    plate = cell.mounting.base_T_cam2.inv() * cell.mounting.base_T_plate
    seen = cell.optics2.look(Sight(plate, PLATE_M, cell.cam2_T_plane(), CONTACT_PX), rng)
    return np.asarray((cell.base_T_cam2.pose * seen.pose).translation[:2])


def _plate_in_camera_1(cell: DrawnCell, rng: np.random.Generator) -> Array:
    commanded = PLUG_STATION * SOCKET.inv() * base_T_flange_over_socket()
    base_T_cam1 = cell.arm.place(commanded, rng) * cell.mounting.flange_T_cam1
    plate = base_T_cam1.inv() * cell.mounting.base_T_plate
    seen = cell.optics1.look(Sight(plate, PLATE_M, cell.cam1_T_plane, CONTACT_PX), rng)
    return np.asarray((commanded * cell.flange_T_cam1.pose * seen.pose).translation[:2])


def _moved(cell: DrawnCell, fault: type[ReferenceMoved], rng: np.random.Generator) -> DrawnCell:
    direction = rng.uniform(0, 2 * np.pi)
    shift = RigidTransform.from_translation(
        [MOVED_M * np.cos(direction), MOVED_M * np.sin(direction), 0.0]
    )
    mounting = cell.mounting
    if fault is FixedCameraMoved:
        mounting = replace(mounting, base_T_cam2=shift * mounting.base_T_cam2)
    elif fault is FlangeCameraMoved:
        mounting = replace(mounting, flange_T_cam1=shift * mounting.flange_T_cam1)
    elif fault is GripperMarksMoved:
        mounting = replace(mounting, flange_T_marks=shift * mounting.flange_T_marks)
    else:
        mounting = replace(mounting, base_T_plate=shift * mounting.base_T_plate)
    return replace(cell, mounting=mounting)
