"""Holds a place of the flange that follows from a recipe against the bounds of the arm's driver."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.edge import farthest_allowed
from cellctl.config.driver_settings import motion_bounds
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.geometry.box import Box
from cellctl.geometry.pose import MM

_EXACT_MM = 1e-3


def flange_place_issues(
    cell: CellConfig,
    robot: str,
    written: Sequence[WrittenValue],
    places: dict[str, RigidTransform],
) -> Iterator[ConfigIssue]:
    """The first of the places, ``base_T_flange`` by what the arm does there, that is outside.

    ``written`` are the values that the places follow from; the first of them is named first.
    Nothing where the driver states no box.
    """
    box = motion_bounds(cell.robots[robot]).flange_box
    if box is None:
        return
    for what, base_T_flange in places.items():
        if not box.holds(base_T_flange.translation):
            x, y, z = base_T_flange.translation / MM
            allowed = (
                f"{what} the flange is at x {x:.0f}, y {y:.0f}, z {z:.0f} mm, outside the box that "
                f"robots.{robot}.settings give it"
            )
            first, *others = written
            against = (*others, box_of(robot, box))
            wanted = f"{first.allowed}: {allowed}" if first.allowed else allowed
            yield ConfigIssue(first.key, first.value, wanted, against=against)
            return


def deepest_mm(
    cell: CellConfig, robot: str, flange_at: Callable[[float], RigidTransform], far_mm: float
) -> float:
    """How far below a place of the flange that is in its box the box ends, at most ``far_mm``.

    ``flange_at`` is ``base_T_flange`` by the way from there in mm.
    """
    box = motion_bounds(cell.robots[robot]).flange_box
    if box is None or box.holds(flange_at(far_mm).translation):
        return far_mm
    return farthest_allowed(
        0.0, far_mm, lambda way_mm: box.holds(flange_at(way_mm).translation), within=_EXACT_MM
    )


def box_of(robot: str, box: Box) -> WrittenValue:
    """The bounds of a flange, as a value that others contradict."""
    lower, upper = (np.round(corner / MM, 1).tolist() for corner in (box.lower_m, box.upper_m))
    return WrittenValue(f"robots.{robot}.settings", f"a box from {lower} to {upper} mm")
