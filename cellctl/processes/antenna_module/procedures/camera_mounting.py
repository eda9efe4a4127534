"""Procedures 203 and 204: where camera I sits on the flange, and camera II beside the robot."""

import asyncio
from dataclasses import asdict, replace

import numpy as np

from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.calibration.solvers.hand_eye.hand_eye import calibrate_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_limits import HandEyeLimits
from cellctl.calibration.solvers.hand_eye.hand_eye_picture import hand_eye_picture
from cellctl.calibration.solvers.hand_eye.hand_eye_result import (
    HandEyePose,
    HandEyeResult,
    RobotNoise,
    Setup,
)
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.clock import utc_now
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.calibrations import (
    CAMERA_1_INTRINSICS,
    CAMERA_2_INTRINSICS,
    FIXED_CAMERA,
    FLANGE_CAMERA,
)
from cellctl.processes.antenna_module.procedures.board_drive import (
    BoardDrive,
    board_of,
    camera_of,
    drive_round_board,
)
from cellctl.processes.antenna_module.settings import ArmSection
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices
from cellctl.workers import SOLVE_S

_LOCAL_SHARE = 0.45
"""Standard deviation per axis among neighbouring poses, as a share of the arm's mean absolute
error."""
_REACH_M = 0.8
"""The lever that makes an error of position from one of angle."""
_LIMITS = HandEyeLimits(position_sigma_m=2e-4, rotation_sigma_rad=float(np.radians(0.03)))
"""Taught plugs take an error of 0.3 mm and 0.05° out again to a micrometre (docs/plugging.md)."""


async def calibrate_mounting_on_cell(
    cell: AntennaCell, services: CellServices, setup: Setup, context: ProcedureContext
) -> ProcedureOutcome:
    """AX = XB with the board on the table, CG = GD with the board on the flange.

    The result holds with the intrinsics that it was made with and names them. Raises the faults of
    the drive and of the store, ``PosesNotDiverse`` or ``RobotCameraMismatch``.
    """
    in_hand = setup is Setup.EYE_IN_HAND
    kind = CAMERA_1_INTRINSICS if in_hand else CAMERA_2_INTRINSICS
    snapshot = await asyncio.to_thread(services.calibrations.read_all, [kind], utc_now())
    # Before the arm moves: intrinsics of a camera that was exchanged are worth nothing.
    serial_number = await camera_of(cell, setup).serial_number()
    snapshot.require_instrument(kind, serial_number)
    drive = await drive_round_board(context, cell, setup)
    workers, camera, noise = cell.workers, snapshot.get(kind), robot_noise(cell.settings.arm)
    await context.keep_input(
        drive.to_input(board_of(cell))
        | {"setup": setup.value, "camera": camera.to_record(), "noise": asdict(noise)}
    )
    result = await workers.run_within(SOLVE_S, mounting_of, drive, camera, setup, noise)
    return ProcedureOutcome(
        kind=FLANGE_CAMERA if in_hand else FIXED_CAMERA,
        record=result.to_record(),
        passed=result.passed,
        warnings=result.warnings,
        picture_png=await workers.run(hand_eye_picture, result),
        serial_number="",
    )


def mounting_of(
    drive: BoardDrive, camera: SingleCameraResult, setup: Setup, noise: RobotNoise
) -> HandEyeResult:
    """The hand-eye calibration of one drive, with the board as the intrinsics have found it."""
    model, board_m = camera.camera.model, camera.board_m
    poses = []
    for stop in drive.stops:
        corners = stop.view.corners
        seen, _ = board_in_camera(model, board_m[corners.ids], corners.pixels)
        poses.append(HandEyePose(stop.view.name, stop.base_T_flange, seen))
    result = calibrate_hand_eye(poses, setup, noise=noise, limits=_LIMITS)
    return replace(result, camera_id=camera.camera.id)


def robot_noise(arm: ArmSection) -> RobotNoise:
    """What neighbouring poses are wrong by against each other: not how well the arm repeats them.

    The arm's errors change smoothly from pose to pose; the solver takes them for noise.
    """
    position_m = _LOCAL_SHARE * arm.absolute_error_mm * MM
    return RobotNoise(max(position_m, 2e-5), max(arm.absolute_error_mm * MM / _REACH_M, 2e-5))
