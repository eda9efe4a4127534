"""How the runs of procedures 101 to 109 are computed anew; that of 108 is a run of the process, of
which its stiffness is computed here and all else as of an assembly."""

import json
from collections.abc import Iterator, Mapping
from functools import partial

from cellctl.calibration.solvers.transfer.board_transfer import calibrate_board_transfer
from cellctl.force.contact.commissioning import joint_stiffness
from cellctl.procedures.input_forms import pose_from_input
from cellctl.procedures.replays import (
    compare_board,
    replay_arm_reference,
    replay_base_frame,
    replay_head,
    replay_payload,
    replay_stop_latency,
)
from cellctl.procedures.target_board import BoardLook, placed_again
from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    BOARD_TRANSFER,
    CONTACT_STIFFNESS,
    PAYLOAD,
    STEREO_HEAD_1,
    STEREO_HEAD_2,
    STOP_LATENCY,
)
from cellctl.processes.deck_to_frame.procedures.board_transfer import (
    HeadPlacement,
    transfer_record,
)
from cellctl.processes.deck_to_frame.procedures.contact_stiffness_result import (
    Touch,
    stiffness_checks,
    stiffness_record,
)
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import HEAD_1
from cellctl.records.replay.procedure_result import compare_result
from cellctl.records.replay.recorded_run import PROCEDURE_INPUT, RecordedRun
from cellctl.records.replay.replayed import Replayed
from cellctl.runtime.procedure import ProcedureReplay


def replay_board(run: RecordedRun) -> Iterator[Replayed]:
    """104 and 105: the board before one head, then both heads, where this run has solved that."""
    given = run.input
    look = BoardLook.from_input(given["look"])
    run.require(file for pair in look.pairs for file in pair)
    recorded = HeadPlacement.from_input(given["placement"])
    board = placed_again(look, run.image)
    yield from compare_board("board in the head", recorded.board.head_T_board, board.head_T_board)
    yield from compare_board(
        "board in the large-field head", recorded.board.c_T_board, board.c_T_board
    )
    if "other_placement" not in given:
        return
    here = HeadPlacement(board, recorded.joints_deg)
    other = HeadPlacement.from_input(given["other_placement"])
    first, second = (here, other) if given["head_role"] == HEAD_1 else (other, here)
    result = calibrate_board_transfer(
        pose_from_input(given["c_T_base"]), [first.board], [second.board]
    )
    yield from compare_result(run, BOARD_TRANSFER.name, transfer_record(result, first, second))


def replay_stiffness(run: RecordedRun) -> Iterator[Replayed]:
    """108: the stiffness from the readings of each contact; nothing for a run without one."""
    if not run.record.document(PROCEDURE_INPUT):
        return
    recipe = DeckRecipe.model_validate(json.loads(run.file("recipe.json"))["recipe"])
    touches = [Touch.from_input(contact) for contact in run.input["contacts"]]
    estimate = joint_stiffness([touch.estimate for touch in touches])
    checks = stiffness_checks(estimate, touches, recipe.mating)
    record = stiffness_record(
        estimate, touches, checks, recipe_id=recipe.id, run_number=run.record.head.number
    )
    yield from compare_result(run, CONTACT_STIFFNESS.for_recipe(recipe.id).name, record)


REPLAYS: Mapping[int, ProcedureReplay] = {
    101: partial(replay_head, name=STEREO_HEAD_1.name),
    102: partial(replay_head, name=STEREO_HEAD_2.name),
    103: partial(replay_base_frame, name=BASE_FRAME.name),
    104: replay_board,
    105: replay_board,
    106: partial(replay_payload, name=PAYLOAD.name),
    107: partial(replay_stop_latency, name=STOP_LATENCY.name),
    109: replay_arm_reference,
}
"""What computes a procedure anew, by its number."""
