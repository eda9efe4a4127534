"""What a person has to know about each procedure of this process: set-up, moves, what follows."""

from cellctl.processes.peg_in_hole.calibrations import CONTACT_LOOP, PANEL_REFERENCE
from cellctl.runtime.guide import Guide

_SET_UP = (
    "The part is gripped as in a run.",
    "The face beside the hole is clean and free.",
)
_TOUCHES = "The robot approaches and touches the face beside the hole, as in a run."
_BACK = "The robot lifts off and drives to the beginning."


def loop(recipe_id: int) -> Guide:
    """Guide to measuring the contact of one recipe's parts."""
    return Guide(
        _SET_UP,
        (_TOUCHES, "The robot presses the face and swings in the air above it.", _BACK),
        renews=(CONTACT_LOOP.for_recipe(recipe_id).name,),
    )


def panel(recipe_id: int) -> Guide:
    """Guide to measuring the face of one recipe's panel."""
    return Guide(_SET_UP, (_TOUCHES, _BACK), renews=(PANEL_REFERENCE.for_recipe(recipe_id).name,))
