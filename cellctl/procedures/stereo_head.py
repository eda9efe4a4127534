"""Calibrate a stereo head on the chessboard, from many views of its robot (paper 2.1.1)."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.boards.board import BoardView, CalibrationBoard
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.cell.image_faults import naming
from cellctl.cell.stereo_station import StereoStation
from cellctl.errors.base import CellError
from cellctl.errors.calibration import BoardNotFound
from cellctl.geometry.pose import MM
from cellctl.procedures.calibration_poses import stereo_views
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome, views_of_pair
from cellctl.workers import SOLVE_S, VisionWorkers

if TYPE_CHECKING:
    from cellctl.calibration.solvers.stereo.stereo_result import StereoResult

WORKING_DISTANCE_M = 0.5
"""Distance from the head to the point about which it swings, along the middle of both lines of
sight: about that at which parts are measured."""


async def calibrate_head(
    context: ProcedureContext,
    station: StereoStation,
    workers: VisionWorkers,
    *,
    board: CalibrationBoard,
    view_count: int,
    kind: "CalibrationKind[StereoResult]",
) -> ProcedureOutcome:
    """Swing the head about the board, find its corners in every pair, solve, and drive back.

    Begins at the pose from which the head sees the board; nothing may stand in its way. After a
    fault the head stays where it is, as any arm does, and the fault says where that is.
    """
    # What computes is loaded when it is used: checks of a cell file load this module for its moves.
    from cellctl.calibration.boards.board_images import BoardImages, detect_view
    from cellctl.calibration.boards.board_record import board_to_record
    from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
    from cellctl.calibration.solvers.stereo.stereo_picture import stereo_picture

    base_T_flange = station.robot.state().base_T_flange
    poses = flange_poses(base_T_flange, station.flange_T_head, view_count)
    views: list[BoardView] = []
    files: list[list[str]] = []
    image_size = (0, 0)
    for number, base_T_flange in enumerate(poses, start=1):
        await context.progress(number, len(poses), f"{station.name}: view")
        with _left_where_it_stands(station, number, len(poses)):
            await _move(station, base_T_flange)
            pair = await station.camera.grab()
            files.append(
                await context.keep_images(f"view-{number}", views_of_pair(station.name, pair))
            )
            # In the order of OpenCV, width first; arrays have the height first.
            image_size = (pair.left.shape[1], pair.left.shape[0])
            with naming(station.name):
                view = await workers.run(
                    detect_view, BoardImages(view_name(number), pair.left, pair.right), board
                )
        # A later view without the board is no fault: at the borders of the field it may be cut off.
        # What all views together must cover, the solver checks. The first is taken from the taught
        # pose, which shows it whole: without it nothing is gained by the minutes of the others.
        if view is not None:
            views.append(view)
        elif number == 1:
            raise BoardNotFound(f"{station.name} sees no {board} from its taught pose")
    # Back before the solution is tried: it may raise, and the head must not be left tilted over the
    # board.
    await _move(station, poses[0])
    await context.keep_input({"board": board_to_record(board), "pairs": files})
    result = await workers.run_within(SOLVE_S, calibrate_stereo, views, board, image_size)
    return ProcedureOutcome(
        kind=kind,
        record=result.to_record(),
        passed=result.passed,
        warnings=result.warnings,
        picture_png=await workers.run(stereo_picture, result),
        serial_number=await station.camera.serial_number(),
    )


def view_name(number: int) -> str:
    """What a view, counted from 1, is called in the result."""
    return f"view {number}"


def flange_poses(
    base_T_flange: RigidTransform, flange_T_head: RigidTransform, count: int
) -> list[RigidTransform]:
    """Targets of the flange: where it is first, then around the middle of both fields."""
    toe_in_rad = flange_T_head.rotation.magnitude()
    # The head is mounted turned by half its toe-in: the bisector of its axes is the flange's.
    pivot_m = WORKING_DISTANCE_M / np.cos(toe_in_rad) * np.array([0.0, 0.0, 1.0])
    head_T_flange = flange_T_head.inv()
    return [
        base_T_flange * flange_T_head * head_T_view * head_T_flange
        for head_T_view in stereo_views(count, pivot_m)
    ]


@contextmanager
def _left_where_it_stands(station: StereoStation, number: int, count: int) -> Iterator[None]:
    """Have a fault say that nothing drives the head back."""
    try:
        yield
    except CellError as fault:
        fault.add_note(
            f"{station.name} was left at or near view {number} of {count}, tilted over the board: "
            "keep its way clear, the next procedure drives it from there"
        )
        raise


async def _move(station: StereoStation, base_T_flange: RigidTransform) -> None:
    await station.robot.move_linear(
        base_T_flange,
        speed_m_s=station.config.linear_speed_mm_s * MM,
        acceleration_m_s2=station.config.linear_acceleration_mm_s2 * MM,
    )
