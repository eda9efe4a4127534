"""Procedures 201 and 202: the intrinsics of camera I and camera II."""

from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.calibration.solvers.single_camera.single_camera_calibration import (
    calibrate_single_camera,
)
from cellctl.calibration.solvers.single_camera.single_camera_picture import single_camera_picture
from cellctl.processes.antenna_module.calibrations import (
    CAMERA_1_INTRINSICS,
    CAMERA_2_INTRINSICS,
)
from cellctl.processes.antenna_module.procedures.board_drive import (
    board_of,
    camera_of,
    drive_round_board,
)
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.workers import SOLVE_S


async def calibrate_camera_on_cell(
    cell: AntennaCell, setup: Setup, context: ProcedureContext
) -> ProcedureOutcome:
    """Drive round the board and adjust camera, views and the bend of the board.

    The drive is that of 203 or 204 and is done again there: a result in the store belongs to the
    procedure that made it, and the hand-eye calibration is made with intrinsics that have passed.
    """
    drive = await drive_round_board(context, cell, setup)
    workers, board = cell.workers, board_of(cell)
    await context.keep_input(drive.to_input(board))
    result = await workers.run_within(
        SOLVE_S, calibrate_single_camera, drive.views, board, drive.image_size
    )
    return ProcedureOutcome(
        kind=CAMERA_1_INTRINSICS if setup is Setup.EYE_IN_HAND else CAMERA_2_INTRINSICS,
        record=result.to_record(),
        passed=result.passed,
        warnings=result.warnings,
        picture_png=await workers.run(single_camera_picture, result),
        serial_number=await camera_of(cell, setup).serial_number(),
    )
