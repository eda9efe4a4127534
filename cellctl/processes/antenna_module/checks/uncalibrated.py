"""What the cell file says of both cameras before there are calibrations to hold them against.

Each camera has one focus. So what it is shown lies about as far from it as the board with which it
is calibrated, and plug and board are shown to camera II at one place.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.store.readable_record import readable_record
from cellctl.config.cell import CellConfig
from cellctl.config.checks.places.over_places import BESIDE_MM, TURNED_DEG, flange_at
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.connector.marks import read_marks
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import (
    ARM,
    BOARD_SHOW,
    CAMERA_1,
    CAMERA_2,
    INSPECT_PLUG,
    REFERENCE_LOOK,
    SOCKET_LOOK,
    TRAY_LOOK,
)
from cellctl.processes.antenna_module.settings import AntennaSettings

_FLANGE_CAMERA, _FIXED_CAMERA = "flange_T_cam1", "base_T_cam2"
"""Names of stored calibrations. Their kinds are not imported: they load all solvers."""
_FOCUS = 0.2
"""Of the distance of the board. At a quarter of a metre a lens that shows holes of half a
millimetre is sharp over far less; stopped down, and with larger marks, over some of it."""


def uncalibrated_remarks(
    cell: CellConfig, recipe: AntennaRecipe, folder: Path
) -> Iterator[ConfigIssue]:
    """Looks that cannot be in focus together, and places that differ as long as nothing measured
    says which is wrong."""
    yield from _out_of_focus(cell, recipe, is_measured=not _lacks(cell, folder, _FLANGE_CAMERA))
    if _lacks(cell, folder, _FIXED_CAMERA):
        yield from _two_places(cell, recipe)


def not_yet_checked(cell: CellConfig, recipe: AntennaRecipe, folder: Path) -> Iterator[str]:
    """What nothing in the file contradicts, and which procedure will."""
    where = f"processes.{recipe.process}"
    camera_1 = recipe.device(CAMERA_1)
    for kind, what in {
        CAMERA_1: f"{where}: board and square_mm; procedure 201 measures with them",
        CAMERA_2: f"{where}: board and square_mm for camera II; procedure 202 measures with them",
        _FLANGE_CAMERA: (
            f"cameras.{camera_1}.flange_T_camera, above all its turn about the axis, and the pose "
            "board_look; procedure 203 measures where the camera is"
        ),
        _FIXED_CAMERA: (
            "where camera II is: that inspect_plug and board_show are over it; procedure 204"
        ),
    }.items():
        if _lacks(cell, folder, kind):
            yield f"{what}, then check again"
    yield _top_of_module(recipe, folder)


def _top_of_module(recipe: AntennaRecipe, folder: Path) -> str:
    """Nobody else states how large the module is: no drawing, no pose, no calibration. So whoever
    has one at hand is told what to measure."""
    top = read_marks(folder / recipe.module_top)
    x_mm, y_mm = (float(one) for one in np.ptp(top.positions_m, axis=0) / MM)
    return (
        f"{recipe.module_top}: nothing else has the size of these marks, and a drawing of half or "
        f"twice the size is found by the first look of a run (F475). Measure a module: by the "
        f"drawing its {len(top.names)} marks are {top.diameter_m / MM:g} mm wide and their middles "
        f"spread over {x_mm:g} x {y_mm:g} mm"
    )


def _lacks(cell: CellConfig, folder: Path, kind: str) -> bool:
    return readable_record(folder / cell.calibration_dir, kind) is None


def _out_of_focus(
    cell: CellConfig, recipe: AntennaRecipe, *, is_measured: bool
) -> Iterator[ConfigIssue]:
    """Camera I much nearer to tray, socket or plate than to its board, or much farther.

    A mounting that is measured is held against its drawing elsewhere, so the board is named then.
    """
    name, settings = recipe.device(CAMERA_1), _settings(cell, recipe)
    written = cell.cameras[name].flange_T_camera
    if written is None:
        return
    top = pose_from_xyzabc(recipe.base_T_tray_plug.pose) * pose_from_xyzabc(recipe.plug_T_top)
    places = {TRAY_LOOK: top, SOCKET_LOOK: pose_from_xyzabc(recipe.base_T_socket.pose)}
    if settings.reference is not None:
        places[REFERENCE_LOOK] = pose_from_xyzabc(settings.reference.base_T_plate.pose)
    away_mm: dict[str, float] = {}
    for pose, base_T_seen in places.items():
        base_T_flange = flange_at(cell, recipe.device(ARM), pose)
        if base_T_flange is not None:
            seen = (base_T_flange * pose_from_xyzabc(written)).inv() * base_T_seen
            away_mm[pose] = float(seen.translation[2]) / MM
    board_mm = settings.board_distance_mm
    if any(abs(one - board_mm) > _FOCUS * board_mm for one in away_mm.values()):
        looks = ", ".join(f"{one:.0f} mm from what {pose} sees" for pose, one in away_mm.items())
        said = (
            f"{looks}, and board_distance_mm = {board_mm:g} from its board, by which it is "
            "focused; right if it is focused from one to the other"
        )
        if is_measured:
            where = f"processes.{recipe.process}.board_distance_mm"
            yield ConfigIssue(where, f"{board_mm:g}", said)
        else:
            yield ConfigIssue(f"cameras.{name}.flange_T_camera", str(list(written)), said)


def _two_places(cell: CellConfig, recipe: AntennaRecipe) -> Iterator[ConfigIssue]:
    """Plug and board that are not shown to camera II at one place.

    Nearer in height than the views of the board from each other, which it has to see sharply.
    """
    arm, settings = recipe.device(ARM), _settings(cell, recipe)
    inspecting, showing = (flange_at(cell, arm, pose) for pose in (INSPECT_PLUG, BOARD_SHOW))
    if inspecting is None or showing is None:
        return
    hangs = RigidTransform.from_translation([0.0, 0.0, settings.flange_T_board_mm * MM])
    plug_T_board = (inspecting * pose_from_xyzabc(recipe.flange_T_plug)).inv() * showing * hangs
    x_mm, y_mm, z_mm = (float(one) for one in plug_T_board.translation / MM)
    beside_mm, axis = float(np.hypot(x_mm, y_mm)), plug_T_board.rotation.as_matrix()[2, 2]
    tilted_deg = float(np.degrees(np.arccos(np.clip(axis, -1.0, 1.0))))
    near_mm = 2.0 * settings.depth_mm
    if beside_mm <= BESIDE_MM and tilted_deg <= TURNED_DEG and abs(z_mm) <= near_mm:
        return
    said = (
        f"here the plug is {beside_mm:.0f} mm beside, {abs(z_mm):.0f} mm above or below and "
        f"{tilted_deg:.0f} deg tilted against the place where {BOARD_SHOW} has the board "
        f"(flange_T_board_mm = {settings.flange_T_board_mm:g}), and camera II sees both; one of "
        "the two poses, flange_T_board_mm or flange_T_plug is wrong"
    )
    key = f"robots.{arm}.poses_deg.{INSPECT_PLUG}"
    yield ConfigIssue(key, str(list(cell.robots[arm].poses_deg[INSPECT_PLUG])), said)


def _settings(cell: CellConfig, recipe: AntennaRecipe) -> AntennaSettings:
    return cast(AntennaSettings, cell.processes[recipe.process])
