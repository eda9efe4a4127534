"""One drive round a calibration board: the flange at every stop, and what the camera saw there."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.boards.board import CalibrationBoard, CameraView
from cellctl.calibration.boards.board_images import BoardImage, detect_camera_view
from cellctl.calibration.boards.board_record import board_to_record
from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.calibration.solvers.hand_eye.one_wrist import require_one_wrist
from cellctl.errors.calibration import BoardNotFound, WrongBoard
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces import Camera
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.looking import Eyes, image_file
from cellctl.processes.antenna_module.moves.moving import Mover
from cellctl.processes.antenna_module.moves.start import leave_stations
from cellctl.processes.antenna_module.procedures.board_poses import swung_poses
from cellctl.processes.antenna_module.roles import BOARD_LOOK, BOARD_SHOW, HOME
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import ProcedureContext


@dataclass(frozen=True, slots=True, eq=False)
class BoardStop:
    """Arm and camera at one stop."""

    base_T_flange: RigidTransform
    view: CameraView


@dataclass(frozen=True, slots=True, eq=False)
class ViewedStop:
    """One stop before anything was looked for in its image."""

    base_T_flange: RigidTransform
    image: str
    """Name of the file."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardDrive:
    """Everything that one drive has shown."""

    stops: tuple[BoardStop, ...]
    """Those from which the board was seen."""
    image_size: tuple[int, int]
    """Width, height in px."""
    looks: tuple[ViewedStop, ...]
    """All stops."""

    @property
    def views(self) -> tuple[CameraView, ...]:
        """The views of all stops."""
        return tuple(stop.view for stop in self.stops)

    def to_input(self, board: CalibrationBoard) -> dict[str, Any]:
        """Plain data, from which ``driven_again`` finds the same."""
        return {
            "board": board_to_record(board),
            "looks": [
                {"image": look.image, "base_T_flange": look.base_T_flange.as_matrix().tolist()}
                for look in self.looks
            ],
        }


def driven_again(
    written: Mapping[str, Any], board: CalibrationBoard, image: Callable[[str], Image]
) -> BoardDrive:
    """The drive from its recorded looks; ``image`` reads one by its file.

    Raises the faults of images that show no board.
    """
    stops, looks, image_size = [], [], (0, 0)
    for number, entry in enumerate(written["looks"], start=1):
        seen = image(entry["image"])
        image_size = (seen.shape[1], seen.shape[0])
        base_T_flange = RigidTransform.from_matrix(np.array(entry["base_T_flange"], float))
        looks.append(ViewedStop(base_T_flange, entry["image"]))
        view = _find(seen, name=_view_name(number), board=board)
        if view is not None:
            stops.append(BoardStop(base_T_flange, view))
    return BoardDrive(tuple(stops), image_size, tuple(looks))


def board_of(cell: AntennaCell) -> CalibrationBoard:
    """The board of the settings; raises ``WrongBoard``."""
    columns, rows = (int(number) for number in cell.settings.board.split("x"))
    board = CalibrationBoard(columns, rows, cell.settings.square_mm * MM)
    # Intrinsics could do with such a board, but a hand-eye calibration needs to know how it lies.
    if board.symmetric:
        raise WrongBoard(f"{board} looks the same turned by 180°; one side must be odd, one even")
    return board


def eyes_of(context: ProcedureContext, cell: AntennaCell) -> Eyes:
    """One image a look, which goes into the record of the procedure."""
    return Eyes(cell.arm, cell.workers, recorder=context.recorder, frames=1, named=context.new_look)


def camera_of(cell: AntennaCell, setup: Setup) -> Camera:
    """Camera I for eye in hand, camera II for eye to hand."""
    return cell.camera_1 if setup is Setup.EYE_IN_HAND else cell.camera_2


async def drive_round_board(
    context: ProcedureContext, cell: AntennaCell, setup: Setup
) -> BoardDrive:
    """Swing camera I about the board on the table, or the board on the flange over camera II.

    Ends at home. Raises ``WrongBoard`` before anything moves, ``BoardNotFound``,
    ``WristConfigurationsDiffer``, the faults of images that show no board, and what moves and
    cameras raise.
    """
    board = board_of(cell)
    mover = Mover(cell)
    await leave_stations(cell)
    await mover.to_taught(BOARD_LOOK if setup is Setup.EYE_IN_HAND else BOARD_SHOW)
    here = cell.arm.robot.state().base_T_flange
    poses = swung_poses(cell.settings, here, _flange_T_pivot(cell, setup))
    drive, joints = await _stops(context, cell, setup, poses)
    await mover.to(here)
    await mover.to_taught(HOME)
    if not drive.stops:
        raise BoardNotFound(f"{camera_of(cell, setup).name} sees no {board} from the taught pose")
    require_one_wrist(joints)
    return drive


async def _stops(
    context: ProcedureContext, cell: AntennaCell, setup: Setup, poses: Sequence[RigidTransform]
) -> tuple[BoardDrive, dict[str, Array]]:
    """The drive, and the joints (rad) by the name of the view."""
    mover, camera = Mover(cell), camera_of(cell, setup)
    eyes = eyes_of(context, cell)
    stops: list[BoardStop] = []
    looks: list[ViewedStop] = []
    joints: dict[str, Array] = {}
    image_size = (0, 0)
    for number, base_T_flange in enumerate(poses, start=1):
        await context.progress(number, len(poses), "view")
        await mover.to(base_T_flange)
        name = _view_name(number)
        find = partial(_find, name=name, board=board_of(cell))
        seen = await eyes.look(f"view-{number}", camera, find)
        looks.append(ViewedStop(seen.base_T_flange, image_file(seen.look)))
        height, width = seen.images[0].shape
        image_size = (width, height)
        view = seen.frames[0]
        # A later view without the board is no fault: at the borders of the picture it may be cut
        # off. What all views together must cover, the solver checks. The first is taken from the
        # taught pose, which shows it whole: without it nothing is gained by the others' minutes.
        if view is not None:
            stops.append(BoardStop(seen.base_T_flange, view))
            joints[name] = seen.joints_rad
        elif number == 1:
            break
    return BoardDrive(tuple(stops), image_size, tuple(looks)), joints


def _view_name(number: int) -> str:
    return f"view {number}"


def _find(image: Image, *, name: str, board: CalibrationBoard) -> CameraView | None:
    return detect_camera_view(BoardImage(name, image), board)


def _flange_T_pivot(cell: AntennaCell, setup: Setup) -> RigidTransform:
    """Middle of the board, x along the width of the picture."""
    settings = cell.settings
    if setup is Setup.EYE_TO_HAND:
        return RigidTransform.from_translation([0.0, 0.0, settings.flange_T_board_mm * MM])
    ahead = RigidTransform.from_translation([0.0, 0.0, settings.board_distance_mm * MM])
    return cell.flange_T_camera_1 * ahead
