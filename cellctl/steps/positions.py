"""Bringing robots to where a run begins, and lifting off where one ended."""

import asyncio

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl import log
from cellctl.cell.devices import Cell
from cellctl.cell.head_station import HeadStation
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.interfaces import RobotState

_log = log.get(__name__)

AT_POSE_RAD = np.radians(0.01)
"""Joints this near a taught pose count as there."""
LIFT_M = 0.06
SLOW_LIFT_M = 0.015
SLOW_SPEED_M_S = 2e-3
"""The first stretch off a seat: pins and edges are still near."""


async def heads_to_measuring_poses(cell: Cell) -> None:
    """Both heads at once; a head that is there already does not move."""
    await asyncio.gather(*(_head_to_measuring_pose(head) for head in cell.heads))


async def _head_to_measuring_pose(head: HeadStation) -> None:
    target_rad = np.radians(head.config.measuring_joints_deg)
    if not _is_at(head.robot.state(), target_rad):
        await head.robot.move_joint(target_rad, speed_ratio=head.config.speed_percent / 100)


async def main_to_home(cell: Cell) -> None:
    """The main robot with its deck clear of station and heads; straight up first when needed."""
    main = cell.config.robots.main
    home_rad = np.radians(main.home_joints_deg)
    if _is_at(cell.main.state(), home_rad):
        return
    await lift_off(cell)
    await cell.main.move_joint(home_rad, speed_ratio=main.speed_percent / 100)


async def lift_off(cell: Cell) -> None:
    """Raise the deck straight off the station, slowly at first; nothing when it is not low."""
    flange = cell.main.state().base_T_flange
    if not _low_in_station(cell, flange):
        return
    main = cell.config.robots.main
    _log.info("lifting off the station")
    stretches = ((SLOW_LIFT_M, SLOW_SPEED_M_S), (LIFT_M, main.linear_speed_mm_s * MM))
    for height_m, speed_m_s in stretches:
        up = RigidTransform.from_translation([0.0, 0.0, height_m])
        await cell.main.move_linear(
            up * flange,
            speed_m_s=speed_m_s,
            acceleration_m_s2=main.linear_acceleration_mm_s2 * MM,
        )


def _low_in_station(cell: Cell, base_T_flange: RigidTransform) -> bool:
    """True when a deck on the flange would be less than the lift above the seat of any recipe."""
    for recipe in cell.config.recipes:
        frame = pose_from_xyzabc(recipe.base_T_frame)
        deck = frame.inv() * base_T_flange * pose_from_xyzabc(recipe.flange_T_deck)
        x_m, y_m, z_m = deck.translation
        low = z_m < recipe.deck_thickness_mm * MM + LIFT_M - 2 * SLOW_LIFT_M
        if low and max(abs(x_m), abs(y_m)) < 0.3:
            return True
    return False


def _is_at(state: RobotState, joints_rad: np.ndarray) -> bool:
    return bool(np.abs(state.joints_rad - joints_rad).max() < AT_POSE_RAD)
