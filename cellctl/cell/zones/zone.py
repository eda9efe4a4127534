"""A zone of the cell file in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.geometry.box import Box
from cellctl.geometry.pose import Array

AT_POSE_RAD = float(np.radians(0.1))
"""Joints this near a taught pose count as there: a move may end so far from its target."""


@dataclass(frozen=True, slots=True, eq=False)
class Share:
    """Where one robot is in a zone."""

    box: Box
    """For the flange, in the base of the robot."""
    clear_poses_rad: tuple[Array, ...]
    """Joints, each of shape (6,), between which joint moves stay out of the zone."""

    def is_clear(self, joints_rad: Array) -> bool:
        """Whether the joints, shape (6,), are those of a clear pose."""
        poses = self.clear_poses_rad
        return any(bool(np.abs(joints_rad - pose).max() <= AT_POSE_RAD) for pose in poses)


@dataclass(frozen=True, slots=True, eq=False)
class Zone:
    """A space for one arm at a time."""

    name: str
    shares: Mapping[str, Share]
    """By the name of the robot."""
    wait_s: float


def zones_of(config: CellConfig) -> tuple[Zone, ...]:
    """The zones of a cell file that was checked."""
    return tuple(
        Zone(
            name,
            {
                robot: Share(
                    Box.from_mm(share.min_mm, share.max_mm),
                    tuple(
                        np.radians(config.robots[robot].poses_deg[pose])
                        for pose in share.clear_poses
                    ),
                )
                for robot, share in zone.robots.items()
            },
            zone.wait_s,
        )
        for name, zone in config.zones.items()
    )
