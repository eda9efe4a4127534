"""What the process needs of a cell (paper, section 1.1): devices in roles, and taught poses."""

from collections.abc import Mapping

from cellctl.config.roles import Role
from cellctl.interfaces import FtSensor, Robot, StereoCamera, TargetTracker

MAIN, FORCE, HEAD_1, HEAD_2, TRACKER = "main", "force", "head_1", "head_2", "tracker"
HOME, DECK_MEASURE = "home", "deck_measure"
"""Poses of the main robot: clear of station and heads; deck above the station, in view."""
MEASURING, RETRACTED = "measuring", "retracted"
"""Poses of a robot that carries a head: over the station; out of the way."""

ROLES: Mapping[str, Role] = {
    MAIN: Role(Robot, "carries the deck", (HOME, DECK_MEASURE)),
    FORCE: Role(FtSensor, "feels the deck, between the flange of the main robot and its gripper"),
    HEAD_1: Role(StereoCamera, "head I over the station", (MEASURING, RETRACTED), carried=True),
    HEAD_2: Role(StereoCamera, "head II over the station", (MEASURING, RETRACTED), carried=True),
    TRACKER: Role(TargetTracker, "large-field head over the cell"),
}
