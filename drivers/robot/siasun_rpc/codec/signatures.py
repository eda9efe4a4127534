"""The calls of the controller's service that this driver makes: arguments and results.

Argument n has field id n, the result has field id 0 (vendor's manual of the remote interface,
API V2.9; docs/protocols/siasun-rpc.md, section 3). One letter stands for a type:

    b bool, h i16, i i32, d double, s string, v nothing
    D list of doubles, B list of bytes, S list of strings, O the structure of a trigger
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Signature:
    """Letters of the arguments in their order, and the letter of the result."""

    arguments: str
    result: str


SIGNATURES = {
    "stop": Signature("b", "i"),
    "rpc_heartbeat": Signature("i", "v"),
    "movej": Signature("DdddbO", "i"),
    "movel": Signature("DdddDssbO", "i"),
    # The last two, smoothing of speed and acceleration, came with Core 3.8. A server that does not
    # know them passes over them, as every Thrift server does with a field that it does not know.
    "servoj_pose": Signature("DddDssbdddd", "i"),
    "get_noneblock_taskstate": Signature("i", "i"),
    "robotmoving": Signature("", "b"),
    "get_robot_state": Signature("", "B"),
    "get_robot_version": Signature("", "s"),
    "get_tcp_pose_coord": Signature("ss", "D"),
    "get_actual_joints_position": Signature("", "D"),
    "get_tool_load": Signature("", "D"),
    "get_tcp_offset": Signature("", "D"),
    "get_wobj": Signature("", "D"),
    "get_last_error": Signature("", "S"),
    "read_word_reg": Signature("h", "i"),
    "write_word_reg": Signature("hi", "i"),
}

NO_TRIGGER = "O"
"""Letter of the structure that is always sent with the values of "nothing happens on the way"."""

TRIGGER_FIELDS: tuple[tuple[str, int | float | bool | str], ...] = (
    ("y", 0), ("y", 1), ("b", False), ("d", 0.0), ("d", 0.0), ("s", ""),
) * 2  # fmt: skip
"""Type and neutral value of its fields 1 to 12: trigger, output, level, two figures, event; six for
the beginning of the motion and six for its end."""
