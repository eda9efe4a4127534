"""Procedures 104, 105: the target board before head I, then II (paper fig. 3, eq. 1 to 3)."""

from cellctl.calibration.board_pose import (
    BoardPoint,
    BoardPose,
    fit_board,
    points_from_targets,
    target_board_discs,
)
from cellctl.calibration.board_transfer import (
    BoardPlacement,
    calibrate_board_transfer,
)
from cellctl.calibration.transfer_picture import transfer_picture
from cellctl.cell.gather import together
from cellctl.cell.stereo_station import HeadStation
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.procedures.clear_cell import clear_the_cell
from cellctl.procedures.context import ProcedureContext, ProcedureOutcome
from cellctl.runtime.calibration_folder import HEAD_JOINTS, Placement
from cellctl.vision.average import average
from cellctl.vision.features import Hole
from cellctl.vision.measure import measure_pair
from cellctl.vision.stereo_head import StereoHead

DISC_DIAMETER_M = 20 * MM
PAIRS = 4
SEARCH_RADIUS_M = 35 * MM
"""Less than half the pitch of the discs."""


async def measure_board(context: ProcedureContext, station: HeadStation) -> ProcedureOutcome | None:
    """Measure the board with head and large-field head; solve once both heads have seen it.

    Returns None while the other head's turn is still to come. A placement serves once: what was
    seen an hour ago, before something else was calibrated, must not meet what is seen now.
    """
    calibrations = context.calibrations
    await clear_the_cell(context, measuring=station)
    model = calibrations.head(station.name)
    await context.progress(1, 1, f"{station.name}: target board")
    in_head, in_large_field = await together(
        _in_head(context, station, model), _in_large_field(context)
    )
    calibrations.placements[station.name] = Placement(
        BoardPlacement(in_large_field, in_head), station.config.measuring_joints_deg
    )
    if len(calibrations.placements) < 2:
        return None
    first, second = (calibrations.placements.pop(name) for name in ("head_1", "head_2"))
    result = await context.cell.workers.run(
        calibrate_board_transfer, calibrations.c_T_base(), [first.board], [second.board]
    )
    joints_deg = {"head_1": first.joints_deg, "head_2": second.joints_deg}
    return ProcedureOutcome(
        item="board_transfer",
        record={**result.to_record(), HEAD_JOINTS: joints_deg},
        passed=result.passed,
        warnings=result.warnings,
        picture_png=await context.cell.workers.run(transfer_picture, result),
        serial_number=await context.cell.tracker.serial_number(),
    )


async def _in_head(context: ProcedureContext, station: HeadStation, model: StereoHead) -> BoardPose:
    drawing = target_board_discs()
    discs = [Hole(name, "disc", DISC_DIAMETER_M, place) for name, place in drawing.items()]
    nominal = pose_from_xyzabc(context.cell.config.procedures.flange_T_target_board)
    head_T_board = pose_from_xyzabc(station.config.flange_T_head).inv() * nominal
    found = []
    for _ in range(PAIRS):
        pair = await station.camera.grab()
        found.append(
            await context.cell.workers.run(
                measure_pair,
                pair.left,
                pair.right,
                model,
                discs,
                camera_T_part=head_T_board,
                search_radius_m=SEARCH_RADIUS_M,
            )
        )
    points = [
        BoardPoint(hole.name, hole.position_m, hole.covariance_m2) for hole in average(found).holes
    ]
    return fit_board(drawing, points)


async def _in_large_field(context: ProcedureContext) -> BoardPose:
    drawing = target_board_discs()
    seen = await context.cell.tracker.measure(context.cell.config.procedures.tracker_frames)
    return fit_board(drawing, points_from_targets(seen, drawing))
