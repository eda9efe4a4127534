"""Holds a place of the flange that follows from a recipe against the bounds of the arm's driver."""

from collections.abc import Iterator

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import motion_bounds
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM


def flange_place_issues(
    cell: CellConfig,
    robot: str,
    written: tuple[str, str],
    places: dict[str, RigidTransform],
) -> Iterator[ConfigIssue]:
    """The first of the places, ``base_T_flange`` by what the arm does there, that is outside.

    ``written`` is the key to be named and its value. Nothing where the driver states no box.
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
            yield ConfigIssue(*written, allowed)
            return
