"""How the runs of procedures 201 to 208 are computed anew; that of 206 is a run of the process."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.boards.board_record import board_from_record
from cellctl.calibration.solvers.hand_eye.hand_eye_result import RobotNoise, Setup
from cellctl.calibration.solvers.single_camera.single_camera_calibration import (
    calibrate_single_camera,
)
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.processes.antenna_module.calibrations import (
    CAMERA_1_INTRINSICS,
    CAMERA_2_INTRINSICS,
    FIXED_CAMERA,
    FLANGE_CAMERA,
    REFERENCE,
    TOOL,
    TOOL_TURN,
)
from cellctl.processes.antenna_module.chain.cell_figures import ArmFigures
from cellctl.processes.antenna_module.chain.reference.reference_looks import ReferenceLooks
from cellctl.processes.antenna_module.chain.teaching.made_with import ReferenceMadeWith
from cellctl.processes.antenna_module.chain.teaching.tool_turn import TurnStop
from cellctl.processes.antenna_module.moves.kept_look import KeptLook, matrix_pose
from cellctl.processes.antenna_module.moves.reference_drive import plate_from_above
from cellctl.processes.antenna_module.moves.turning import turn_stop
from cellctl.processes.antenna_module.procedures.board_drive import driven_again
from cellctl.processes.antenna_module.procedures.camera_mounting import mounting_of
from cellctl.processes.antenna_module.procedures.teach_reference import reference_of
from cellctl.processes.antenna_module.procedures.touch_tool import tool_of
from cellctl.processes.antenna_module.procedures.turn_tool import turned_tool
from cellctl.records.replay.procedure_result import compare_result
from cellctl.records.replay.recorded_run import RecordedRun
from cellctl.records.replay.replayed import Replayed
from cellctl.runtime.procedure import ProcedureReplay


def replay_intrinsics(run: RecordedRun, name: str) -> Iterator[Replayed]:
    """201 and 202: a camera from the images of the board."""
    given = run.input
    run.require(look["image"] for look in given["looks"])
    board = board_from_record(given["board"])
    drive = driven_again(given, board, run.image)
    result = calibrate_single_camera(drive.views, board, drive.image_size)
    yield from compare_result(run, name, result.to_record())


def replay_mounting(run: RecordedRun, name: str) -> Iterator[Replayed]:
    """203 and 204: where a camera sits, from the same and the poses of the flange."""
    given = run.input
    run.require(look["image"] for look in given["looks"])
    result = mounting_of(
        driven_again(given, board_from_record(given["board"]), run.image),
        SingleCameraResult.from_record(given["camera"]),
        Setup(given["setup"]),
        RobotNoise(**given["noise"]),
    )
    yield from compare_result(run, name, result.to_record())


def replay_reference(run: RecordedRun) -> Iterator[Replayed]:
    """205: axis, marks and plate from the images of both cameras."""
    given = run.input
    marks, above, below = (_kept(run, name) for name in ("marks", "above", "below"))
    flange_T_cam1, base_T_cam2 = (
        matrix_pose(given[name]) for name in ("flange_T_cam1", "base_T_cam2")
    )
    seen = [
        plate_from_above(
            look.base_T_flange * flange_T_cam1 * look.again(run.image), look.base_T_flange
        )
        for look in above
    ]
    looks = ReferenceLooks(
        turns=tuple(_turn_stops(run, marks, base_T_cam2)),
        plate_in_camera_1=tuple(place_m for place_m, _ in seen),
        plate_in_camera_2=tuple(
            (base_T_cam2 * look.again(run.image)).translation[:2] for look in below
        ),
        lever_m=max(away_m for _, away_m in seen),
    )
    made_with = ReferenceMadeWith.from_record(given["made_with"])
    taught = reference_of(made_with, looks, ArmFigures(**given["arm"]))
    yield from compare_result(run, REFERENCE.name, taught.to_record())


def replay_turns(run: RecordedRun) -> Iterator[Replayed]:
    """207: the marks beside the flange axis, from the images of camera II."""
    given = run.input
    stops = list(_turn_stops(run, _kept(run, "marks"), matrix_pose(given["base_T_cam2"])))
    flanges = [matrix_pose(matrix) for matrix in given["base_T_flange"]]
    result = turned_tool(stops, flanges, np.array(given["drawn_m"], float))
    yield from compare_result(run, TOOL_TURN.name, result.to_record())


def _kept(run: RecordedRun, name: str) -> list[KeptLook]:
    looks = [KeptLook.from_input(look) for look in run.input[name]]
    run.require(look.image for look in looks)
    return looks


def _turn_stops(
    run: RecordedRun, looks: Sequence[KeptLook], base_T_cam2: RigidTransform
) -> Iterator[TurnStop]:
    for look in looks:
        base_T_marks = base_T_cam2 * look.again(run.image)
        yield turn_stop(look.angle_rad, base_T_marks, look.base_T_flange)


def replay_touches(run: RecordedRun) -> Iterator[Replayed]:
    """208: the tool from where the flange was at each touch."""
    poses = [matrix_pose(pose) for pose in run.input["base_T_flange"]]
    yield from compare_result(run, TOOL.name, tool_of(poses).to_record())


REPLAYS: Mapping[int, ProcedureReplay] = {
    201: partial(replay_intrinsics, name=CAMERA_1_INTRINSICS.name),
    202: partial(replay_intrinsics, name=CAMERA_2_INTRINSICS.name),
    203: partial(replay_mounting, name=FLANGE_CAMERA.name),
    204: partial(replay_mounting, name=FIXED_CAMERA.name),
    205: replay_reference,
    207: replay_turns,
    208: replay_touches,
}
"""What computes a procedure anew, by its number."""
