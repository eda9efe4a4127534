"""Procedures 104 and 105: from head I to head II by the target board (paper fig. 3, eq. 1 to 3)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from cellctl.calibration.solvers.transfer.board_transfer import (
    BoardPlacement,
    TransferResult,
    calibrate_board_transfer,
)
from cellctl.calibration.solvers.transfer.transfer_picture import transfer_picture
from cellctl.calibration.store.store import CalibrationStore
from cellctl.config.base import JointsDeg
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.procedures.input_forms import board_from_input, board_to_input, pose_to_input
from cellctl.procedures.target_board import place_board
from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    BOARD_TRANSFER,
    STEREO_HEAD_1,
    STEREO_HEAD_2,
)
from cellctl.processes.deck_to_frame.record_names import HEAD_JOINTS
from cellctl.processes.deck_to_frame.roles import HEAD_1, HEAD_2, MEASURING
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.workers import SOLVE_S

_CAMERAS = {HEAD_1: STEREO_HEAD_1, HEAD_2: STEREO_HEAD_2}
"""The calibration of the cameras of each head, by its role."""


@dataclass(frozen=True, slots=True)
class HeadPlacement:
    """The target board before one head, waiting for the other head's turn."""

    board: BoardPlacement
    joints_deg: JointsDeg
    """The measuring pose from which the head saw it."""

    def to_input(self) -> dict[str, Any]:
        """Plain data with all digits."""
        return {
            "c_T_board": board_to_input(self.board.c_T_board),
            "head_T_board": board_to_input(self.board.head_T_board),
            "joints_deg": list(self.joints_deg),
        }

    @classmethod
    def from_input(cls, written: Mapping[str, Any]) -> "HeadPlacement":
        """The inverse of ``to_input``."""
        c_T_board, head_T_board = (
            board_from_input(written[name]) for name in ("c_T_board", "head_T_board")
        )
        return cls(BoardPlacement(c_T_board, head_T_board), tuple(written["joints_deg"]))


@dataclass(slots=True)
class WaitingPlacements:
    """What procedure 104 or 105 has seen and its counterpart has not yet; gone with the daemon.

    A calibration of a head, or whatever invalidates one, makes what that head has seen worthless.
    """

    by_head: dict[str, HeadPlacement] = field(default_factory=dict)

    def take(self, first: str, second: str) -> tuple[HeadPlacement, HeadPlacement] | None:
        """The placements before both heads, once; None while one of them is still to come.

        Once, because what was seen an hour ago, before something else was calibrated, must not
        meet what is seen now.
        """
        if not {first, second} <= self.by_head.keys():
            return None
        return self.by_head.pop(first), self.by_head.pop(second)

    def drop(self, kind: str) -> None:
        """Forget what was seen through a head that was calibrated anew; ignores other kinds."""
        for head, cameras in _CAMERAS.items():
            if cameras.name == kind:
                self.by_head.pop(head, None)

    def clear(self) -> None:
        """Forget everything that was seen."""
        self.by_head.clear()


async def measure_board(
    context: ProcedureContext,
    cell: DeckCell,
    head: str,
    calibrations: CalibrationStore,
    waiting: WaitingPlacements,
) -> ProcedureOutcome | None:
    """Measure the board with head and large-field head; solve once both heads have seen it.

    ``head`` is the role of the head before which the board lies now. Returns None while the other
    head's turn is still to come.
    """
    station = cell.head(head)
    model = calibrations.read(_CAMERAS[head]).head
    await context.progress(1, 1, f"{station.name}: target board")
    board, look = await place_board(
        context,
        station,
        model,
        cell.tracker,
        cell.workers,
        flange_T_board=pose_from_xyzabc(cell.settings.flange_T_target_board),
        tracker_frames=cell.settings.tracker_frames,
    )
    here = HeadPlacement(board, station.config.poses_deg[MEASURING])
    waiting.by_head[head] = here
    both = waiting.take(HEAD_1, HEAD_2)
    seen = {"head_role": head, "look": look.to_input(), "placement": here.to_input()}
    if both is None:
        await context.keep_input(seen)
        return None
    c_T_base = calibrations.read(BASE_FRAME).c_T_base
    first, second = both
    other = second if first is here else first
    made_with = {"other_placement": other.to_input(), "c_T_base": pose_to_input(c_T_base)}
    await context.keep_input(seen | made_with)
    result = await cell.workers.run_within(
        SOLVE_S, calibrate_board_transfer, c_T_base, [first.board], [second.board]
    )
    return ProcedureOutcome(
        kind=BOARD_TRANSFER,
        record=transfer_record(result, first, second),
        passed=result.passed,
        warnings=result.warnings,
        picture_png=await cell.workers.run(transfer_picture, result),
        serial_number=await cell.tracker.serial_number(),
    )


def transfer_record(
    result: TransferResult, first: HeadPlacement, second: HeadPlacement
) -> dict[str, Any]:
    """What is stored; it holds for the measuring poses from which both heads saw the board."""
    joints_deg = {HEAD_1: first.joints_deg, HEAD_2: second.joints_deg}
    return {**result.to_record(), HEAD_JOINTS: joints_deg}
