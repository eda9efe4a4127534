"""Procedures 104 and 105: from head I to head II by the target board (paper fig. 3, eq. 1 to 3)."""

from dataclasses import dataclass, field

from cellctl.calibration.board_transfer import BoardPlacement, calibrate_board_transfer
from cellctl.calibration.transfer_picture import transfer_picture
from cellctl.cell.stereo_station import StereoStation
from cellctl.config.base import JointsDeg
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.procedures.target_board import place_board
from cellctl.processes.deck_to_frame.roles import HEAD_1, HEAD_2, MEASURING
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.runtime.calibration_folder import HEAD_JOINTS, CalibrationFolder
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome


@dataclass(frozen=True, slots=True)
class HeadPlacement:
    """The target board before one head, waiting for the other head's turn."""

    board: BoardPlacement
    joints_deg: JointsDeg
    """The measuring pose from which the head saw it."""


@dataclass(slots=True)
class WaitingPlacements:
    """What procedure 104 or 105 has seen and its counterpart has not yet; gone with the daemon.

    A calibration of a head, or whatever invalidates one, makes what that head has seen worthless.
    """

    by_head: dict[str, HeadPlacement] = field(default_factory=dict)

    def drop(self, head: str) -> None:
        """What this head has seen counts no longer; nothing for other names."""
        self.by_head.pop(head, None)

    def clear(self) -> None:
        """Nothing that was seen counts any longer."""
        self.by_head.clear()


async def measure_board(
    context: ProcedureContext,
    cell: DeckCell,
    station: StereoStation,
    calibrations: CalibrationFolder,
    waiting: WaitingPlacements,
) -> ProcedureOutcome | None:
    """Measure the board with head and large-field head; solve once both heads have seen it.

    Returns None while the other head's turn is still to come. A placement serves once: what was
    seen an hour ago, before something else was calibrated, must not meet what is seen now.
    """
    model = calibrations.head(station.name)
    await context.progress(1, 1, f"{station.name}: target board")
    board = await place_board(
        station,
        model,
        cell.tracker,
        cell.workers,
        flange_T_board=pose_from_xyzabc(cell.settings.flange_T_target_board),
        tracker_frames=cell.settings.tracker_frames,
    )
    placements = waiting.by_head
    placements[station.name] = HeadPlacement(board, station.config.poses_deg[MEASURING])
    if len(placements) < 2:
        return None
    first, second = (placements.pop(head.name) for head in cell.heads)
    result = await cell.workers.run(
        calibrate_board_transfer, calibrations.c_T_base(), [first.board], [second.board]
    )
    joints_deg = {HEAD_1: first.joints_deg, HEAD_2: second.joints_deg}
    return ProcedureOutcome(
        item="board_transfer",
        record={**result.to_record(), HEAD_JOINTS: joints_deg},
        passed=result.passed,
        warnings=result.warnings,
        picture_png=await cell.workers.run(transfer_picture, result),
        serial_number=await cell.tracker.serial_number(),
    )
