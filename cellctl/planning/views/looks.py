"""Places from which a head can look at its holes, as few numbers."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array
from cellctl.vision.camera.stereo_head import StereoHead

_DISTANCES = 5
"""Distances that are tried, evenly over what the head sees sharply."""
_TILTS_RAD, _TILT_DIRECTIONS = np.radians([0.0, 10.0, 20.0, 30.0]), 8
"""Angles between the line of sight and the normal of the parts, and the directions of each tilt."""
_ROLLS = 12
"""Turns of the baseline about the line of sight."""


@dataclass(frozen=True, slots=True)
class HeadLook:
    """Where the middle of a head is, seen from what it looks at."""

    distance_m: float
    tilt_x_rad: float = 0.0
    """Rotation vector by which the line of sight leaves the normal of the parts."""
    tilt_y_rad: float = 0.0
    roll_rad: float = 0.0
    """Turn of the baseline about the line of sight."""
    shift_x_m: float = 0.0
    """Shift of the place it looks at, in the plane of the parts."""
    shift_y_m: float = 0.0

    def cell_T_middle(self, cell_T_aim: RigidTransform) -> RigidTransform:
        """``cell_T_aim``: the middle of the holes, z into the parts."""
        turn = Rotation.from_rotvec([self.tilt_x_rad, self.tilt_y_rad, 0.0])
        turn = turn * Rotation.from_euler("z", self.roll_rad)
        aim_T_middle = np.eye(4)
        aim_T_middle[:3, :3] = turn.as_matrix()
        aimed_m = np.array([self.shift_x_m, self.shift_y_m, 0.0])
        aim_T_middle[:3, 3] = aimed_m - self.distance_m * aim_T_middle[:3, 2]
        # A product of rotations is one; a chain of transforms would look at each step whether it
        # is.
        return RigidTransform(cell_T_aim.as_matrix() @ aim_T_middle, normalize=False)

    def neighbours(self, step: float) -> Iterator["HeadLook"]:
        """One number changed at a time; ``step`` 1 is that of the grid, about."""
        sizes = {
            "distance_m": 0.04,
            "tilt_x_rad": float(np.radians(6.0)),
            "tilt_y_rad": float(np.radians(6.0)),
            "roll_rad": float(np.radians(15.0)),
            "shift_x_m": 0.03,
            "shift_y_m": 0.03,
        }
        for name, size in sizes.items():
            for sign in (1.0, -1.0):
                yield replace(self, **{name: getattr(self, name) + sign * size * step})


def grid_of_looks(nearest_m: float, farthest_m: float) -> Iterator[HeadLook]:
    """Evenly over the distances that are in focus, tilts in all directions, and rolls."""
    reach_m = farthest_m - nearest_m
    # Not at the ends: the holes of a head are not all at one distance.
    for distance_m in np.linspace(
        nearest_m + 0.1 * reach_m, farthest_m - 0.1 * reach_m, _DISTANCES
    ):
        for tilt_x, tilt_y in _tilts():
            for roll in 2.0 * np.pi * np.arange(_ROLLS) / _ROLLS:
                yield HeadLook(float(distance_m), tilt_x, tilt_y, float(roll))


def look_of(cell_T_middle: RigidTransform, cell_T_aim: RigidTransform) -> HeadLook:
    """The look from a place, the inverse of ``HeadLook.cell_T_middle``.

    The line of sight must not be parallel to the parts.
    """
    seen = cell_T_aim.inv() * cell_T_middle
    forward = seen.rotation.apply([0.0, 0.0, 1.0])
    distance_m = float(-seen.translation[2] / forward[2])
    aimed_m = seen.translation + distance_m * forward
    tilt = np.array([-forward[1], forward[0], 0.0])
    size = float(np.linalg.norm(tilt))
    if size > 0.0:
        tilt *= np.arctan2(size, forward[2]) / size
    rest = Rotation.from_rotvec(tilt).inv() * seen.rotation
    roll = float(np.arctan2(rest.as_matrix()[1, 0], rest.as_matrix()[0, 0]))
    return HeadLook(
        distance_m, float(tilt[0]), float(tilt[1]), roll, float(aimed_m[0]), float(aimed_m[1])
    )


# A head does not change, and a search asks for it at each of thousands of places.
@lru_cache(maxsize=64)
def left_T_middle(head: StereoHead) -> RigidTransform:
    """Half way between both cameras: z along the middle of both lines of sight, x to the right."""
    right_T_left = head.right_T_left
    right_m = right_T_left.inv().translation
    forward = np.array([0.0, 0.0, 1.0]) + right_T_left.inv().rotation.apply([0.0, 0.0, 1.0])
    forward /= np.linalg.norm(forward)
    across = right_m - (right_m @ forward) * forward
    across /= np.linalg.norm(across)
    axes = np.column_stack([across, np.cross(forward, across), forward])
    return RigidTransform.from_components(right_m / 2, Rotation.from_matrix(axes))


@lru_cache(maxsize=64)
def middle_T_left(head: StereoHead) -> RigidTransform:
    """The inverse of ``left_T_middle``."""
    return left_T_middle(head).inv()


def aim_at(places_m: Array, cell_T_part: RigidTransform) -> RigidTransform:
    """The middle of places in the cell, shape (n, 3); z into the part, x as that of the part."""
    axes = cell_T_part.rotation.as_matrix() @ np.diag([1.0, -1.0, -1.0])
    return RigidTransform.from_components(np.mean(places_m, axis=0), Rotation.from_matrix(axes))


def _tilts() -> Iterator[tuple[float, float]]:
    for tilt_rad in _TILTS_RAD.tolist():
        directions = _TILT_DIRECTIONS if tilt_rad else 1
        for direction in 2.0 * np.pi * np.arange(directions) / _TILT_DIRECTIONS:
            yield float(tilt_rad * np.cos(direction)), float(tilt_rad * np.sin(direction))
