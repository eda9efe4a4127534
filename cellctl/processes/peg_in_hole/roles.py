"""What the process needs of a cell: devices in roles, and taught poses."""

from collections.abc import Mapping

from cellctl.config.roles import Role
from cellctl.interfaces import FtSensor
from cellctl.interfaces.streaming_robot import StreamingRobot

ARM, FORCE = "arm", "force"
HOME = "home"
"""Pose of the arm clear of the part with the hole."""
ABOVE_HOLE = "above_hole"
"""The tip over the believed place of the hole, clear of its face, in the attitude of insertion."""

ROLES: Mapping[str, Role] = {
    ARM: Role(
        StreamingRobot,
        "carries the peg and follows a stream",
        (HOME, ABOVE_HOLE),
        rests_at=(HOME,),
    ),
    FORCE: Role(FtSensor, "feels the peg, between the flange of the arm and the gripper"),
}
