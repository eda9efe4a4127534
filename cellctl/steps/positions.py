"""Bringing robots to where a run begins, and lifting off where one ended."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl import log
from cellctl.cell.devices import Cell
from cellctl.cell.head_station import HeadStation
from cellctl.cell.together import together
from cellctl.config.base import JointsDeg
from cellctl.config.recipe import Recipe
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.interfaces import RobotState
from cellctl.steps.plausible import is_near

_log = log.get(__name__)

AT_POSE_RAD = np.radians(0.001)
"""Joints this near a taught pose count as there: 0.04 mm at the end of a head's arm."""
LIFT_M = 0.06
SLOW_LIFT_M = 0.015
SLOW_SPEED_M_S = 2e-3
"""The first stretch off a seat: pins and edges are still near."""
LOW_M = 0.03
"""A deck less than this above its seat is lifted before it goes anywhere else."""
NEAR_STATION_M = 0.8
"""Along either axis of the frame, between its middle and the deck's: they may overlap."""


async def heads_to_measuring_poses(cell: Cell) -> None:
    """Both heads at once; a head that is there already does not move."""
    await together(*(head_to_measuring_pose(head) for head in cell.heads))


async def head_to_measuring_pose(head: HeadStation) -> None:
    """One head; it does not move when it is there already."""
    await _head_to(head, head.config.measuring_joints_deg)


async def head_to_retracted_pose(head: HeadStation) -> None:
    """One head out of the way; it does not move when it is there already."""
    await _head_to(head, head.config.retracted_joints_deg)


async def _head_to(head: HeadStation, joints_deg: JointsDeg) -> None:
    target_rad = np.radians(joints_deg)
    if not _is_at(head.robot.state(), target_rad):
        await head.robot.move_joint(target_rad, speed_ratio=head.config.speed_percent / 100)


async def main_to_home(cell: Cell) -> None:
    """The main robot with its deck clear of station and heads; off the station first if low."""
    main = cell.config.robots.main
    home_rad = np.radians(main.home_joints_deg)
    if _is_at(cell.main.state(), home_rad):
        return
    await lift_off(cell)
    await cell.main.move_joint(home_rad, speed_ratio=main.speed_percent / 100)


async def lift_off(cell: Cell) -> None:
    """Move the deck away from the station along the approach, slowly at first.

    The direction is the normal of the frame as measured last, else as the recipe has it. Nothing
    moves when the deck is not low over the station.
    """
    base_T_flange = cell.main.state().base_T_flange
    base_T_frame = _frame_below(cell, base_T_flange)
    if base_T_frame is None:
        return
    away = base_T_frame.rotation.apply([0.0, 0.0, 1.0])
    main = cell.config.robots.main
    _log.info("lifting off the station")
    stretches = ((SLOW_LIFT_M, SLOW_SPEED_M_S), (LIFT_M, main.linear_speed_mm_s * MM))
    for height_m, speed_m_s in stretches:
        await cell.main.move_linear(
            RigidTransform.from_translation(height_m * away) * base_T_flange,
            speed_m_s=speed_m_s,
            acceleration_m_s2=main.linear_acceleration_mm_s2 * MM,
        )


def _frame_below(cell: Cell, base_T_flange: RigidTransform) -> RigidTransform | None:
    """The frame of the first recipe that a deck on the flange would be low over."""
    for recipe in cell.config.recipes:
        nominal = pose_from_xyzabc(recipe.base_T_frame)
        if _is_low(recipe, nominal.inv() * base_T_flange * pose_from_xyzabc(recipe.flange_T_deck)):
            measured = cell.base_T_frame
            known = measured is not None and is_near(recipe, nominal, measured)
            return measured if known else nominal
    return None


def _is_low(recipe: Recipe, frame_T_deck: RigidTransform) -> bool:
    x_m, y_m, z_m = frame_T_deck.translation
    low = z_m < recipe.deck_thickness_mm * MM + LOW_M
    return bool(low and max(abs(x_m), abs(y_m)) < NEAR_STATION_M)


def _is_at(state: RobotState, joints_rad: Array) -> bool:
    return bool(np.abs(state.joints_rad - joints_rad).max() < AT_POSE_RAD)
