"""What a person has to know about each procedure of this process: set-up, moves, what follows."""

from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    BOARD_TRANSFER,
    CONTACT_STIFFNESS,
    PAYLOAD,
    STEREO_HEAD_1,
    STEREO_HEAD_2,
    STOP_LATENCY,
)
from cellctl.runtime.guide import Guide

_CLEAR = "The main robot drives home, then the heads drive to their retracted poses."
_BUT_ONE = (
    "The main robot drives home, the other head to its retracted pose, this head to its measuring "
    "pose."
)
_RING = "Six targets are on the flange ring."
_EMPTY = "The station is empty."
_NO_DECK = "The deck is taken out of the gripper."
"""Its space is swung through, and the model counts it as away (docs/planning.md, absent_in)."""
_GRIPPED = "The deck is gripped, clear of the station."
_FULL_SPEED = "The speed override of the main robot is at its full value."
_LIGHT = "The light on it is bright and even."
_BOTH_BOARDS = "Only both boards together give a result; do not restart the daemon between them."

_HEAD = (
    ("The calibration board lies under the head.", _LIGHT, _NO_DECK),
    (_BUT_ONE, "The head swings about the board, stops for each view, and drives back."),
)
HEAD_1 = Guide(*_HEAD, renews=(STEREO_HEAD_1.name,))
HEAD_2 = Guide(*_HEAD, renews=(STEREO_HEAD_2.name,))
BASE = Guide(
    (_RING, _EMPTY, _NO_DECK),
    (_CLEAR, "The main robot turns about its axis A1, then about its axis A2, with stops."),
    renews=(BASE_FRAME.name,),
)
BOARD_1 = Guide(
    ("The target board lies under head 1, where the large-field head sees it.", _LIGHT),
    (_BUT_ONE, "Nothing else moves."),
    ("Put the target board under head 2 and run the procedure for board 2.", _BOTH_BOARDS),
    renews=(BOARD_TRANSFER.name,),
)
BOARD_2 = Guide(
    ("The target board lies under head 2, where the large-field head sees it.", _LIGHT),
    (_BUT_ONE, "Nothing else moves."),
    (_BOTH_BOARDS,),
    renews=(BOARD_TRANSFER.name,),
)
WEIGHING = Guide(
    (_GRIPPED,),
    (_CLEAR, "The main robot tilts the deck in the air, stops for each pose, and drives home."),
    renews=(PAYLOAD.name,),
)
STOPPING = Guide(
    (_GRIPPED, _FULL_SPEED),
    (_CLEAR, "The main robot rises slowly, is stopped on the way and returns, again and again."),
    renews=(STOP_LATENCY.name,),
)
REFERENCE = Guide(
    (_RING, _EMPTY, _NO_DECK),
    (_CLEAR, "The main robot goes to the middle of its arcs, is looked at, and drives home."),
    ("Nothing is stored: an arm that is off its reference is a fault.",),
)


def stiffness(recipe_id: int) -> Guide:
    """Guide to measuring the stiffness of one recipe's parts."""
    return Guide(
        (
            _GRIPPED,
            "A frame is on the station; both are sacrificial parts.",
            _FULL_SPEED,
            "All other calibrations are valid.",
        ),
        (
            "The main robot and both heads move as in an assembly: they measure and correct.",
            "The deck is pressed onto the frame several times, up to the target force.",
        ),
        renews=(CONTACT_STIFFNESS.for_recipe(recipe_id).name,),
    )
