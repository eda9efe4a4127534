"""Brings the robots to the taught poses from which a run begins."""

import numpy as np

from cellctl.cell.gather import gather_or_cancel
from cellctl.cell.guarded_motion.free_moves import move_joint_free
from cellctl.cell.stereo_station import StereoStation
from cellctl.config.via_points import has_way, via_points
from cellctl.geometry.pose import Array
from cellctl.interfaces import RobotState
from cellctl.processes.deck_to_frame.moves.lift_off import is_over_station, lift_off
from cellctl.processes.deck_to_frame.roles import DECK_MEASURE, HOME, MEASURING, RETRACTED
from cellctl.processes.deck_to_frame.stations import DeckCell

AT_POSE_RAD = np.radians(0.001)
"""Joints this near a taught pose count as there: 0.04 mm at the end of a head's arm."""


async def heads_to_measuring_poses(cell: DeckCell) -> None:
    """Both heads at once; a head that is there already does not move."""
    await gather_or_cancel(*(head_to_measuring_pose(head) for head in cell.heads))


async def head_to_measuring_pose(head: StereoStation) -> None:
    """One head; it does not move when it is there already."""
    await _head_to(head, MEASURING)


async def head_to_retracted_pose(head: StereoStation) -> None:
    """One head out of the way; it does not move when it is there already."""
    await _head_to(head, RETRACTED)


async def _head_to(head: StereoStation, pose: str) -> None:
    target_rad = np.radians(head.config.poses_deg[pose])
    state = head.robot.state()
    if not _is_at(state, target_rad):
        for joints_rad in (*via_points(head.config, state.joints_rad, pose), target_rad):
            await head.robot.move_joint(joints_rad, speed_ratio=head.config.speed_percent / 100)


async def main_to_home(cell: DeckCell) -> None:
    """The main robot with its deck clear of station and heads; off the station first if low."""
    home_rad = np.radians(cell.main_config.poses_deg[HOME])
    if _is_at(cell.main.state(), home_rad):
        return
    # A joint move would swing a deck that is low over the station through whatever stands there.
    await lift_off(cell)
    if is_over_station(cell) and has_way(cell.main_config, DECK_MEASURE, HOME):
        # The way begins there, and from here straight home leads through the heads.
        await main_to_pose(cell, DECK_MEASURE)
    await main_to_pose(cell, HOME)


async def main_to_pose(cell: DeckCell, pose: str) -> None:
    """The main robot to a taught pose under the guard, on the way that the cell file states."""
    config = cell.main_config
    target_rad = np.radians(config.poses_deg[pose])
    for joints_rad in (*via_points(config, cell.main.state().joints_rad, pose), target_rad):
        await move_joint_free(cell.cell, cell.arm, joints_rad)


def _is_at(state: RobotState, joints_rad: Array) -> bool:
    return bool(np.abs(state.joints_rad - joints_rad).max() < AT_POSE_RAD)
