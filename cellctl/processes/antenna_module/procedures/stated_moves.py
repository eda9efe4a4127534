"""The moves of the procedures 201 to 207; by touches (208) an operator moves the arm alone."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import pairwise, permutations

from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.moves import StatedMove, StatedPlace
from cellctl.errors.config import ConfigInvalid
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.chain.reference.reference_looks import turn_angles
from cellctl.processes.antenna_module.moves.places import OVER_SOCKET_M, WAITING_M, turned
from cellctl.processes.antenna_module.moves.stated_places import PluggingPlaces
from cellctl.processes.antenna_module.procedures.board_poses import swung_poses
from cellctl.processes.antenna_module.roles import (
    BOARD_LOOK,
    BOARD_SHOW,
    CAMERA_1,
    HOME,
    INSPECT_PLUG,
    REFERENCE_LOOK,
    SOCKET_LOOK,
)
from cellctl.processes.antenna_module.settings import AntennaSettings

_OUTERMOST = 4
"""So many looks at the marks are at the outermost angles alone: all others lie between those."""


def procedure_moves(places: PluggingPlaces, settings: AntennaSettings) -> Iterator[StatedMove]:
    """Each begins at home; the way back there is stated with those of a run."""
    far_board = _flange_T_far_board(places, settings)
    on_flange = RigidTransform.from_translation([0.0, 0.0, settings.flange_T_board_mm * MM])
    by_procedures: list[tuple[set[int], Iterable[StatedMove]]] = [
        ({201, 203}, _round_the_board(places, settings, BOARD_LOOK, far_board)),
        ({202, 204}, _round_the_board(places, settings, BOARD_SHOW, on_flange)),
        # Step 10 of a run makes the turns of 205.
        (set(), _turns(places, settings)),
        ({206}, _waiting(places)),
    ]
    for numbers, moves in by_procedures:
        yield from (replace(move, procedures=frozenset(numbers)) for move in moves)


def _flange_T_far_board(places: PluggingPlaces, settings: AntennaSettings) -> RigidTransform:
    """The board on the table, as camera I sees it at its taught pose."""
    name = places.recipe.device(CAMERA_1)
    written = places.cell.cameras[name].flange_T_camera
    if written is None:
        raise ConfigInvalid(f"cameras.{name}.flange_T_camera is missing")
    ahead = RigidTransform.from_translation([0.0, 0.0, settings.board_distance_mm * MM])
    return pose_from_xyzabc(written) * ahead


def _round_the_board(
    places: PluggingPlaces, settings: AntennaSettings, pose: str, flange_T_board: RigidTransform
) -> Iterator[StatedMove]:
    """201 to 204."""
    look = places.taught(pose)
    yield places.joint(places.taught(HOME), look)
    swung = swung_poses(settings, places.arm.flange_at(look), flange_T_board)
    views = [
        StatedPlace(f"{pose}, view {number}", look.joints_rad, base_T_flange)
        for number, base_T_flange in enumerate(swung[1:], start=2)
    ]
    for start, end in pairwise([look, *views, look]):
        yield places.linear(start, end)


def _turns(places: PluggingPlaces, settings: AntennaSettings) -> Iterator[StatedMove]:
    """205 and 207, and step 10 of a run: the marks over camera II, and the plate between."""
    inspect = places.taught(INSPECT_PLUG)
    turns = [
        StatedPlace(f"{INSPECT_PLUG}, turn {number}", turned(inspect.joints_rad, angle_rad))
        for number, angle_rad in enumerate(turn_angles(_OUTERMOST), start=1)
    ]
    for turn in turns:
        yield places.joint(places.taught(HOME), turn)
    for start, end in permutations(turns, 2):
        yield places.joint(start, end)
    if settings.reference is not None:
        plate = places.taught(REFERENCE_LOOK)
        for turn in turns:
            yield places.joint(turn, plate)
            yield places.joint(plate, turn)


def _waiting(places: PluggingPlaces) -> Iterator[StatedMove]:
    """206: over the socket, where the operator takes over."""
    waiting = places.over_face("waiting over the socket", WAITING_M)
    over = places.raised("over where the arm waits", waiting, OVER_SOCKET_M)
    yield from places.climbing(places.taught(SOCKET_LOOK), over)
    yield places.linear(over, waiting, approach=True)
