"""Poses from which a camera does not see what it is taught to look at.

Places that the cell file gives are held against it with errors. Places that were measured are held
against it with remarks: a calibration may be older than what was changed.
"""

from collections.abc import Iterator
from math import pi
from pathlib import Path
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.pose_record import pose_from_record
from cellctl.calibration.store.readable_record import readable_record
from cellctl.config.cell import CellConfig
from cellctl.config.checks.places.over_places import ChainedPose, Over, over_place_issues
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.recipe import AntennaRecipe, Place
from cellctl.processes.antenna_module.roles import (
    ARM,
    BOARD_LOOK,
    BOARD_SHOW,
    CAMERA_1,
    INSPECT_PLUG,
    REFERENCE_LOOK,
    SOCKET_LOOK,
    TRAY_LOOK,
)
from cellctl.processes.antenna_module.settings import AntennaSettings

OVER = RigidTransform.from_rotation(Rotation.from_rotvec([pi, 0.0, 0.0]))
"""A plug in its socket, a camera over its board: their z axes point against each other."""
_FLANGE_CAMERA, _FIXED_CAMERA, _REFERENCE = "flange_T_cam1", "base_T_cam2", "reference"
"""Names of stored calibrations. Their kinds are not imported: they load all solvers."""
_MOUNTED_MM, _MOUNTED_DEG = 8.0, 3.0
"""A bracket is made and screwed on to less than this."""
_PLATE_MM = 5.0
"""The plate is a good deal wider; farther off its dots would be looked for beside it."""


def look_issues(cell: CellConfig, recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
    """Camera I over tray, socket and reference plate, by the places that the file gives."""
    arm, name = recipe.device(ARM), recipe.device(CAMERA_1)
    written = cell.cameras[name].flange_T_camera
    if written is None:
        return
    camera = ChainedPose(f"cameras.{name}.flange_T_camera", written)
    top, itself = pose_from_xyzabc(recipe.plug_T_top), RigidTransform.identity()
    places: dict[str, tuple[str, Place, RigidTransform]] = {
        TRAY_LOOK: (f"{key}.base_T_tray_plug", recipe.base_T_tray_plug, top),
        SOCKET_LOOK: (f"{key}.base_T_socket", recipe.base_T_socket, itself),
    }
    reference = _settings(cell, recipe).reference
    if reference is not None:
        where = f"processes.{recipe.process}.reference.base_T_plate"
        places[REFERENCE_LOOK] = (where, reference.base_T_plate, itself)
    for pose, (where, place, place_T_seen) in places.items():
        base_T_seen = pose_from_xyzabc(place.pose) * place_T_seen * OVER
        links = [ChainedPose(f"{where}.pose", place.pose, after=place_T_seen * OVER)]
        if pose == TRAY_LOOK:
            base_T_plug = pose_from_xyzabc(place.pose)
            links.append(ChainedPose(f"{key}.plug_T_top", recipe.plug_T_top, base_T_plug, OVER))
        over = Over(
            arm,
            pose,
            pose_from_xyzabc(written),
            base_T_seen,
            where,
            tuple(links),
            (camera,),
            any_turn=True,
        )
        yield from over_place_issues(cell, over)


def look_remarks(cell: CellConfig, recipe: AntennaRecipe, folder: Path) -> Iterator[ConfigIssue]:
    """What was measured: both cameras, the board on the table, and the plate."""
    yield from _fixed_camera(cell, recipe, folder)
    yield from _flange_camera(cell, recipe, folder)
    yield from _plate(cell, recipe, folder)


def _fixed_camera(cell: CellConfig, recipe: AntennaRecipe, folder: Path) -> Iterator[ConfigIssue]:
    """Plug and board over camera II."""
    record = readable_record(folder / cell.calibration_dir, _FIXED_CAMERA)
    if record is None:
        return
    base_T_camera = pose_from_record(record["base_T_camera"]).pose
    arm, board_mm = recipe.device(ARM), _settings(cell, recipe).flange_T_board_mm
    shown = {
        INSPECT_PLUG: pose_from_xyzabc(recipe.flange_T_plug),
        BOARD_SHOW: RigidTransform.from_translation([0.0, 0.0, board_mm * MM]),
    }
    for pose, flange_T_shown in shown.items():
        place = base_T_camera * OVER
        over = Over(arm, pose, flange_T_shown, place, _FIXED_CAMERA, any_turn=True)
        yield from _remarked(cell, over, _FIXED_CAMERA)


def _flange_camera(cell: CellConfig, recipe: AntennaRecipe, folder: Path) -> Iterator[ConfigIssue]:
    """Camera I on the flange, and over the board that it was calibrated with."""
    record = readable_record(folder / cell.calibration_dir, _FLANGE_CAMERA)
    name = recipe.device(CAMERA_1)
    written = cell.cameras[name].flange_T_camera
    if record is None or written is None:
        return
    measured = pose_from_record(record["flange_T_camera"]).pose
    between = measured.inv() * pose_from_xyzabc(written)
    away_mm = float(np.linalg.norm(between.translation)) / MM
    turned_deg = float(np.degrees(between.rotation.magnitude()))
    if away_mm > _MOUNTED_MM or turned_deg > _MOUNTED_DEG:
        said = (
            f"{away_mm:.0f} mm and {turned_deg:.0f} deg away from where the stored "
            f"{_FLANGE_CAMERA} has this camera; right if it was mounted otherwise since"
        )
        yield ConfigIssue(f"cameras.{name}.flange_T_camera", str(list(written)), said)
    board = pose_from_record(record["base_T_board"]).pose
    # A board has no side that it shows to the camera: its z may point either way.
    to_board = board if board.rotation.as_matrix()[2, 2] < 0.0 else board * OVER
    arm = recipe.device(ARM)
    over = Over(arm, BOARD_LOOK, measured, to_board, _FLANGE_CAMERA, any_turn=True)
    yield from _remarked(cell, over, _FLANGE_CAMERA)


def _plate(cell: CellConfig, recipe: AntennaRecipe, folder: Path) -> Iterator[ConfigIssue]:
    record = readable_record(folder / cell.calibration_dir, _REFERENCE)
    reference = _settings(cell, recipe).reference
    if record is None or reference is None:
        return
    written = reference.base_T_plate.pose
    measured_mm = np.array(record["plate_in_camera_1_mm"])
    away_mm = float(np.linalg.norm(measured_mm - written[:2]))
    if away_mm > _PLATE_MM:
        said = (
            f"{away_mm:.0f} mm beside x {measured_mm[0]:.0f}, y {measured_mm[1]:.0f} mm, where the "
            f"stored {_REFERENCE} has the plate; right if the plate was moved since"
        )
        where = f"processes.{recipe.process}.reference.base_T_plate.pose"
        yield ConfigIssue(where, str(list(written)), said)


def _remarked(cell: CellConfig, over: Over, kind: str) -> Iterator[ConfigIssue]:
    for issue in over_place_issues(cell, over):
        said = (
            f"by the stored {kind} not {issue.allowed}; right if something was moved since"
        ).replace("that the recipe gives", "that was measured")
        yield ConfigIssue(issue.key, issue.value, said)


def _settings(cell: CellConfig, recipe: AntennaRecipe) -> AntennaSettings:
    return cast(AntennaSettings, cell.processes[recipe.process])
