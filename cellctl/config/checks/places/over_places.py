"""Holds a taught pose of an arm against the place over which its tool must be there."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc, pose_to_xyzabc

BESIDE_MM, TURNED_DEG = 50.0, 10.0
"""A pose is taught by eye over a place that a drawing gives: nearer than this it is the same."""
HIGHEST_MM = 300.0
"""Greatest height over a place; from higher up nobody teaches an approach."""
NEAR_MM, NEAR_DEG, GAUGED_MM = 10.0, 3.0, 5.0
"""A pose whose height was measured as it was taught: jogged to its place within a few millimetres
and upright by a square. A rule is read to a millimetre or two, an arm whose geometry was not
calibrated is off by as much, and so is a place that a drawing gives."""
ROUND_DEG = 8.0
"""Turn about its own axis of a round tool that was jogged by eye; slips are of 10 deg and more."""


_NOTHING = RigidTransform.identity()

_HALF_TURN_DEG = 180.0


@dataclass(frozen=True, slots=True, eq=False)
class ChainedPose:
    """A written pose from which a tool, or its place, follows: ``before * pose * after``."""

    key: str
    written: Sequence[float]
    """mm and degrees, shape (6,)."""
    before: RigidTransform = _NOTHING
    after: RigidTransform = _NOTHING

    def value(
        self, whole: RigidTransform, is_good: Callable[[RigidTransform], bool]
    ) -> WrittenValue:
        """As it is written, with what it would have to be for ``whole`` to follow from it, or
        another one that is good and needs another turn only."""
        pose = self.before.inv() * whole * self.after.inv()
        written_m = pose_from_xyzabc(self.written).translation
        turned = RigidTransform.from_components(written_m, pose.rotation)
        if is_good(self.before * turned * self.after):
            pose = turned
        return WrittenValue(self.key, str(list(self.written)), allowed=about(pose))


def about(pose: RigidTransform) -> str:
    """A pose in its written form, as what another value would have to be."""
    rounded = np.round(pose_to_xyzabc(pose), 1) + 0.0
    rounded[3:] = np.where(rounded[3:] == -_HALF_TURN_DEG, _HALF_TURN_DEG, rounded[3:])
    return f"about {rounded.tolist()}"


@dataclass(frozen=True, slots=True, eq=False)
class Over:
    """A place, and the pose that was taught over it."""

    robot: str
    pose: str
    flange_T_tool: RigidTransform
    base_T_tool: RigidTransform
    """Pose of the tool at the place itself; its z axis leads to it."""
    key: str
    """Key of the place in the recipe, or name of the calibration that has it."""
    of_place: tuple[ChainedPose, ...] = ()
    """The values that the place follows from."""
    of_tool: tuple[ChainedPose, ...] = ()
    """The values that the tool follows from."""
    height_mm: float | None = None
    """How high over the place the tool was when the pose was taught; None where nobody measured."""
    any_turn: bool = False
    """Whether the tool may be turned about its z axis, as a camera may that looks at the place."""
    is_round: bool = False
    """Whether nobody aligns the tool about its z axis, as a pin without keys."""


def flange_at(cell: CellConfig, robot: str, pose: str) -> RigidTransform | None:
    """base_T_flange at a taught pose; None where the driver's settings have no kinematics."""
    driver, settings = robot_driver(cell.robots[robot])
    kinematics = driver.forward_kinematics(settings)
    if kinematics is None:
        return None
    joints_rad: Array = np.radians(cell.robots[robot].poses_deg[pose])
    return kinematics(joints_rad)


def _turned_deg(tool_T_taught: RigidTransform, over: Over) -> float:
    turned_deg = float(np.degrees(tool_T_taught.rotation.magnitude()))
    if not (over.any_turn or (over.is_round and turned_deg <= ROUND_DEG)):
        return turned_deg
    along_z = float(tool_T_taught.rotation.as_matrix()[2, 2])
    return float(np.degrees(np.arccos(np.clip(along_z, -1.0, 1.0))))


def over_place_issues(cell: CellConfig, over: Over) -> Iterator[ConfigIssue]:
    """A taught pose at which the tool is beside its place, in it, turned away or far above."""
    base_T_flange = flange_at(cell, over.robot, over.pose)
    if base_T_flange is None:
        return
    tool_T_taught = over.base_T_tool.inv() * base_T_flange * over.flange_T_tool
    x_mm, y_mm, z_mm = (float(one) for one in tool_T_taught.translation / MM)
    if _is_over(over, tool_T_taught):
        return
    turned_deg = _turned_deg(tool_T_taught, over)
    beside_mm, height_mm = float(np.hypot(x_mm, y_mm)), -z_mm
    most_mm, most_deg, least_height_mm, most_height_mm = _bounds(over)
    key = f"robots.{over.robot}.poses_deg.{over.pose}"
    allowed = (
        f"over the place that the recipe gives, {least_height_mm:g} to {most_height_mm:g} mm, at "
        f"most {most_mm:g} mm beside it and turned by at most {most_deg:g} deg; here the tool is "
        f"{height_mm:.0f} mm over it, {beside_mm:.0f} mm beside it and turned by {turned_deg:.0f} "
        "deg"
    )
    joints = str(list(cell.robots[over.robot].poses_deg[over.pose]))
    against = (*_links(over, base_T_flange, tool_T_taught), *_height(over, height_mm))
    yield ConfigIssue(key, joints, allowed, against=against)


def _links(
    over: Over, base_T_flange: RigidTransform, tool_T_taught: RigidTransform
) -> Iterator[WrittenValue]:
    """Every written pose that takes part, with what it would have to be."""
    meant = _nearest_good(over, tool_T_taught)
    place = base_T_flange * over.flange_T_tool * meant.inv()
    tool = base_T_flange.inv() * over.base_T_tool * meant

    def is_place(base_T_tool: RigidTransform) -> bool:
        return _is_over(over, base_T_tool.inv() * base_T_flange * over.flange_T_tool)

    def is_tool(flange_T_tool: RigidTransform) -> bool:
        return _is_over(over, over.base_T_tool.inv() * base_T_flange * flange_T_tool)

    yield from (link.value(place, is_place) for link in over.of_place)
    yield from (link.value(tool, is_tool) for link in over.of_tool)


def _is_over(over: Over, tool_T_taught: RigidTransform) -> bool:
    x_mm, y_mm, z_mm = tool_T_taught.translation / MM
    most_mm, most_deg, least_height_mm, most_height_mm = _bounds(over)
    is_high_enough = bool(least_height_mm <= -z_mm <= most_height_mm)
    is_near = bool(np.hypot(x_mm, y_mm) <= most_mm)
    return is_high_enough and is_near and _turned_deg(tool_T_taught, over) <= most_deg


def _nearest_good(over: Over, tool_T_taught: RigidTransform) -> RigidTransform:
    """The taught tool seen from its place, with only that changed which is out of bounds."""
    x_mm, y_mm, z_mm = tool_T_taught.translation / MM
    most_mm, most_deg, least_height_mm, most_height_mm = _bounds(over)
    if np.hypot(x_mm, y_mm) > most_mm:
        x_mm = y_mm = 0.0
    if not least_height_mm <= -z_mm <= most_height_mm:
        z_mm = -(least_height_mm + most_height_mm) / 2.0
    turn = tool_T_taught.rotation
    if _turned_deg(tool_T_taught, over) > most_deg:
        turn = Rotation.identity()
    return RigidTransform.from_components(np.array([x_mm, y_mm, z_mm]) * MM, turn)


def _height(over: Over, height_mm: float) -> Iterator[WrittenValue]:
    if over.height_mm is not None:
        # A tool at its place, or in it, was at no height that anybody can have measured.
        wanted = f"about {height_mm:.0f}" if round(height_mm) > 0 else ""
        key = f"{over.key}.taught_above_mm"
        yield WrittenValue(key, f"{over.height_mm:g}", allowed=wanted)


def _bounds(over: Over) -> tuple[float, float, float, float]:
    """Most mm beside the place, most degrees, least and greatest height over it in mm."""
    if over.height_mm is None:
        return BESIDE_MM, TURNED_DEG, 0.0, HIGHEST_MM
    # By the figures of the file the tool may stand a little below a place that it was just above.
    return NEAR_MM, NEAR_DEG, over.height_mm - GAUGED_MM, over.height_mm + GAUGED_MM


def unmeasured_height(cell: CellConfig, over: Over) -> Iterator[ConfigIssue]:
    """A remark on a place with which only contact would show that its height is wrong."""
    if over.height_mm is not None or flange_at(cell, over.robot, over.pose) is None:
        return
    said = (
        f"how far over the place the tool was as {over.pose} was taught, by a rule: without it "
        "neither the height nor a tilt of place and tool is held against the cell before contact"
    )
    yield ConfigIssue(f"{over.key}.taught_above_mm", "(missing)", said)
