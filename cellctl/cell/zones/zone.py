"""A zone of the cell file in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.geometry.box import Box
from cellctl.geometry.pose import Array

AT_POSE_RAD = float(np.radians(0.1))
"""Joints this near a taught pose count as there: a move may end so far from its target."""


_FACES = {
    f"{sign}{axis}": (index, sign == "+") for index, axis in enumerate("xyz") for sign in "-+"
}


@dataclass(frozen=True, slots=True, eq=False)
class Share:
    """The part of one robot in a zone."""

    box: Box
    """Box in which the flange is inside the zone, in the base of the robot."""
    clear_poses_rad: tuple[Array, ...]
    """Joints, each of shape (6,), between which joint moves stay out of the zone."""
    way_out: tuple[int, bool] | None = None
    """Axis across the face of the box through which the arm leaves, and whether it is the upper."""

    def is_clear(self, joints_rad: Array) -> bool:
        """Whether the joints, shape (6,), are those of a clear pose."""
        poses = self.clear_poses_rad
        return any(bool(np.abs(joints_rad - pose).max() <= AT_POSE_RAD) for pose in poses)


@dataclass(frozen=True, slots=True, eq=False)
class Zone:
    """A space for one arm at a time."""

    name: str
    shares: Mapping[str, Share]
    """Shares by the name of the robot."""
    wait_s: float
    retreat: tuple[str, ...] = ()
    """Robots in the order in which they leave when more than one of them is inside."""

    def leaves_before(self, robot: str, other: str) -> bool:
        """Whether a robot may lead its arm out while the other one stands inside."""
        if robot not in self.retreat:
            return False
        later = self.retreat[self.retreat.index(robot) + 1 :]
        return other in later or other not in self.retreat


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
                    None if share.way_out is None else _FACES[share.way_out],
                )
                for robot, share in zone.robots.items()
            },
            zone.wait_s,
            zone.retreat,
        )
        for name, zone in config.zones.items()
    )
