"""Holds the joint targets of procedure 103 against the bounds of the robot that turns."""

from collections.abc import Iterator

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.errors.robot import TargetOutOfBounds
from cellctl.processes.deck_to_frame.settings import DeckSettings

_TURNED = (0, 1)
"""Axes A1 and A2."""


def base_frame_turn_issues(
    cell: CellConfig, main: str, settings: DeckSettings, process: str
) -> Iterator[ConfigIssue]:
    """The start of the turns, and both ends of each axis's arc around it."""
    driver, driver_settings = robot_driver(cell.robots[main])
    start_deg = np.array(settings.base_frame_joints_deg)
    half_deg = settings.circle_arc_deg / 2.0
    turns = [np.zeros(6)]
    turns += [sign * half_deg * np.eye(6)[axis] for axis in _TURNED for sign in (-1.0, 1.0)]
    for turn_deg in turns:
        try:
            driver.check_joint_target(driver_settings, np.radians(start_deg + turn_deg))
        except TargetOutOfBounds as fault:
            key = f"processes.{process}.base_frame_joints_deg"
            allowed = f"procedure 103 turns A1 and A2 by {half_deg:g} deg each way: {fault.detail}"
            yield ConfigIssue(key, str(start_deg.tolist()), allowed, fault.number)
            # One is enough: another start or a smaller arc changes all of them.
            return
