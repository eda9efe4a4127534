"""What a person has to know about each procedure of this process: set-up, moves, what follows."""

from cellctl.processes.antenna_module.calibrations import (
    CAMERA_1_INTRINSICS,
    CAMERA_2_INTRINSICS,
    FIXED_CAMERA,
    FLANGE_CAMERA,
    PLUG_CORRECTION,
    REFERENCE,
    TOOL,
    TOOL_TURN,
)
from cellctl.runtime.guide import Guide

_LEAVES = "The robot leaves the station it stands in and drives home."
_EMPTY = "The gripper is empty."
_BOARD_LIES = (
    ("The calibration board lies where camera I sees it from the taught pose.", _EMPTY),
    (_LEAVES, "The robot swings camera I about the board, stops for each view, and drives home."),
)
_BOARD_HANGS = (
    (
        "The calibration board is on the flange, and camera II sees it at the taught pose.",
        # It lies within the space that the board is swung through (docs/planning.md).
        "The reference plate is taken away.",
        _EMPTY,
    ),
    (_LEAVES, "The robot swings the board over camera II, stops for each view, and drives home."),
)
CAMERA_1 = Guide(
    *_BOARD_LIES,
    ("Run the procedure for camera I on the flange next: the board stays where it is.",),
    renews=(CAMERA_1_INTRINSICS.name,),
)
CAMERA_2 = Guide(
    *_BOARD_HANGS,
    ("Run the procedure for camera II beside the robot next: the board stays where it is.",),
    renews=(CAMERA_2_INTRINSICS.name,),
)
ON_FLANGE = Guide(*_BOARD_LIES, renews=(FLANGE_CAMERA.name,))
BESIDE = Guide(
    *_BOARD_HANGS,
    ("Take the calibration board off the flange, and put the reference plate back.",),
    renews=(FIXED_CAMERA.name,),
)
TAUGHT = Guide(
    (_EMPTY, "The reference plate is in its place."),
    (
        _LEAVES,
        "The robot turns the marks of the gripper over camera II, looks at the plate, and drives "
        "home.",
    ),
    renews=(REFERENCE.name,),
)
TURNED = Guide(
    (_EMPTY,),
    (_LEAVES, "The robot turns the marks of the gripper over camera II, and drives home."),
    renews=(TOOL_TURN.name,),
)
TOUCHED = Guide(
    ("A fixed tip stands where the tip of the gripper reaches it from several sides.",),
    (
        "The robot does not move by itself: a person jogs it at its panel.",
        "For each touch: key to manual, jog as the progress says, key back to remote.",
    ),
    renews=(TOOL.name,),
)


def plugged(recipe_id: int) -> Guide:
    """Guide to teaching the plugs of one recipe."""
    return Guide(
        ("Modules lie on the tray, the first one ready.", "The socket is free."),
        (
            "The robot finds and picks a module as in production, and waits above the socket.",
            "A person plugs it: key to manual, jog until it sits, key back to remote.",
            "The gripper opens, and the robot lifts off slowly.",
            "Take the plugged module out and lay the next one on the tray, until all are done.",
        ),
        renews=(PLUG_CORRECTION.for_recipe(recipe_id).name,),
    )
