"""What the process needs of a cell (paper, section 1.1): devices in roles, and taught poses."""

from collections.abc import Mapping

from cellctl.config.roles import Role
from cellctl.interfaces import FtSensor, Robot, StereoCamera, TargetTracker

MAIN, FORCE, HEAD_1, HEAD_2, TRACKER = "main", "force", "head_1", "head_2", "tracker"
HOME, DECK_MEASURE = "home", "deck_measure"
"""Poses of the main robot: clear of station and heads; deck above the station, in view."""
MEASURING, RETRACTED = "measuring", "retracted"
"""Poses of a robot that carries a head: over the station; out of the way."""


def _head(text: str) -> Role:
    return Role(StereoCamera, text, (MEASURING, RETRACTED), (RETRACTED,), carried=True)


ROLES: Mapping[str, Role] = {
    MAIN: Role(Robot, "carries the deck", (HOME, DECK_MEASURE), rests_at=(HOME,)),
    FORCE: Role(FtSensor, "feels the deck, between the flange of the main robot and its gripper"),
    HEAD_1: _head("head I over the station"),
    HEAD_2: _head("head II over the station"),
    TRACKER: Role(TargetTracker, "large-field head over the cell"),
}
