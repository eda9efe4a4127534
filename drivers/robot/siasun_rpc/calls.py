"""The calls that move the arm. None of them blocks its connection, and none is blended."""

import math
from typing import cast

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from drivers.robot.siasun_rpc.codec.messages import Request
from drivers.robot.siasun_rpc.config import SiasunRpcConfig
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.watch import write_pose

_AT_ONCE = False
"""The reply is the number of the task and does not wait for its end. A call that waited would hold
its connection, and nobody could ask how far the task is."""
_NO_BLEND = 0.0
"""A blended motion ends as interrupted, like one that another client has pushed aside: only without
blending does "finished" tell a good end (vendor's manual, API V2.9)."""
_GAINS = (200.0, 25.0)
"""Proportional and differential figure of the controller's servo control, its own defaults."""


def move_joint(config: SiasunRpcConfig, joints_rad: Array, percent: int) -> Request:
    """movej at a percentage of the rated speed."""
    acceleration_percent = float(config.joint_acceleration_percent)
    return request(
        "movej", _floats(joints_rad), float(percent), acceleration_percent, _NO_BLEND, _AT_ONCE
    )


def move_linear(
    config: SiasunRpcConfig,
    base_T_flange: RigidTransform,
    near_rad: Array,
    *,
    speed_m_s: float,
    acceleration_m_s2: float,
) -> Request:
    """movel; ``near_rad`` says in which branch of the joints to find a solution."""
    return request(
        "movel",
        write_pose(base_T_flange, config.euler),
        speed_m_s,
        acceleration_m_s2,
        _NO_BLEND,
        _floats(near_rad),
        config.tool,
        config.work_frame,
        _AT_ONCE,
    )


def servo(config: SiasunRpcConfig, base_T_flange: RigidTransform, near_rad: Array) -> Request:
    """servoj_pose: a new target in place of the one before."""
    return request(
        "servoj_pose",
        write_pose(base_T_flange, config.euler),
        math.radians(config.servo_joint_speed_deg_s),
        math.radians(config.servo_joint_acceleration_deg_s2),
        _floats(near_rad),
        config.tool,
        config.work_frame,
        _AT_ONCE,
        *_GAINS,
        config.servo_smooth_speed,
        config.servo_smooth_acceleration,
    )


def _floats(joints_rad: Array) -> list[float]:
    return cast(list[float], joints_rad.tolist())
