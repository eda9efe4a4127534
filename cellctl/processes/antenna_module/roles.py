"""What the process needs of a cell: devices in roles, and taught poses."""

from collections.abc import Mapping

from cellctl.config.roles import Role
from cellctl.interfaces import Camera, FtSensor, Gripper, Robot

ARM, FORCE, CAMERA_1, CAMERA_2, GRIPPER = "arm", "force", "camera_1", "camera_2", "gripper"
HOME = "home"
"""Pose of the arm clear of tray, socket and camera II."""
TRAY_LOOK, INSPECT_PLUG, SOCKET_LOOK = "tray_look", "inspect_plug", "socket_look"
"""Camera I over the tray; the plug over camera II; camera I over the socket, with the flange at the
height and in the orientation of plugging."""
ABOVE_TRAY, ABOVE_SOCKET = "above_tray", "above_socket"
"""The plug over its place on the tray, and over its socket, in the attitude in which it lies or
goes in. No move goes there: what the recipe says of tray, socket and plug is held against them."""
BOARD_LOOK, BOARD_SHOW = "board_look", "board_show"
"""Poses for calibration: camera I over the board on the table; the board on the flange over camera
II."""
REFERENCE_LOOK = "reference_look"
"""Camera I over the reference plate, in a cell that has one. No lower than ``inspect_plug``: on the
way between both the fingers pass over the plate."""

ROLES: Mapping[str, Role] = {
    ARM: Role(
        Robot,
        "carries gripper, force sensor and camera I",
        (HOME, TRAY_LOOK, INSPECT_PLUG, SOCKET_LOOK, BOARD_LOOK, BOARD_SHOW),
        rests_at=(HOME,),
    ),
    FORCE: Role(FtSensor, "feels the plug, between the flange of the arm and the gripper"),
    CAMERA_1: Role(Camera, "camera I: looks at tray and socket", carried=True),
    CAMERA_2: Role(Camera, "camera II: fixed, looks up at the plug in the gripper"),
    GRIPPER: Role(Gripper, "holds the module"),
}
