"""Boxes of arms whose kinematics are not known, held against the tool that comes down in them."""

from collections.abc import Iterator, Sequence

from cellctl.config.cell import CellConfig
from cellctl.config.checks.places.sensor_places import straight_mm
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue


def tool_floor_remarks(
    cell: CellConfig, robot: str, flange_T_tool: Sequence[float]
) -> Iterator[ConfigIssue]:
    """A box so low that a tool that points down would go through the plane the arm stands on.

    Of an arm with known kinematics ``box_remarks`` say more. ``flange_T_tool`` is in its written
    form, mm.
    """
    driver, settings = robot_driver(cell.robots[robot])
    # By convention drivers give the corner of the box of straight moves this name
    # (docs/writing-a-robot-driver.md).
    lower_mm = cell.robots[robot].settings.get("workspace_min_mm")
    long_mm = straight_mm(flange_T_tool)
    if driver.forward_kinematics(settings) is not None or lower_mm is None or long_mm is None:
        return
    below_mm = long_mm - lower_mm[2]
    if below_mm > 0.0:
        said = (
            f"with the flange at its lower face a tool of {long_mm:g} mm that points down is "
            f"{below_mm:.0f} mm below the plane on which the arm stands: right if the arm stands "
            "on a pedestal or works into a pit"
        )
        yield ConfigIssue(f"robots.{robot}.settings.workspace_min_mm", str(lower_mm), said)
