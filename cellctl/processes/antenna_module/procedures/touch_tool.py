"""Procedure 208: the tool by touches, four points and three points, jogged by somebody.

The tip of the gripper is brought to one fixed point in several orientations of the flange, which
gives its place; then in one orientation to that point, along its x axis, and to the side of its y
axis, which gives its axes. Each touch ends with the key back on remote. One that cannot be what was
asked for is not taken: the operator is told why, and asked again.
"""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.tool.tool import (
    MIN_TRAVEL_M,
    STILL_RAD,
    ToolResult,
    calibrate_tool,
)
from cellctl.calibration.solvers.tool.tool_picture import tool_picture
from cellctl.cell.guarded_motion.settling import settle
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.calibrations import TOOL
from cellctl.processes.antenna_module.faults.calibration import NobodyTouched
from cellctl.processes.antenna_module.procedures.by_hand import PATIENCE, Patience, jogged_by_hand
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome

TOUCHES = 8
"""Tilted by 45° in four directions, at two turns about the tip's axis 90° apart: so the tip is
determined alike in all directions."""
_ANEW_RAD = float(np.radians(20.0))
"""Two touches that differ by less count as one: those that are asked for differ by 60° and more."""
ORIENTING = ("tip on the point", "tip along its x axis", "tip to the side of its y axis")


async def touch_tool_on_cell(
    cell: AntennaCell, context: ProcedureContext, patience: Patience = PATIENCE
) -> ProcedureOutcome:
    """Collect the poses of all touches and solve; the arm is moved by the operator alone.

    Raises ``NobodyTouched``, ``PosesNotDiverse``, ``IllConditioned`` and ``NotSettled``.
    """
    total = TOUCHES + len(ORIENTING)
    poses: list[RigidTransform] = []
    refused = ""
    while len(poses) < total:
        what = ("tip on the point, tilted anew", *ORIENTING)[max(0, len(poses) - TOUCHES + 1)]
        await context.progress(len(poses) + 1, total, f"{refused}by hand: {what},")
        await jogged_by_hand(cell.arm.robot, NobodyTouched, patience)
        await settle(cell.arm.guard)
        pose = cell.arm.robot.state().base_T_flange
        problem = what_is_wrong(pose, poses)
        refused = f"not taken, {problem}; " if problem else ""
        if not problem:
            poses.append(pose)
    await context.keep_input({"base_T_flange": [pose.as_matrix().tolist() for pose in poses]})
    result = tool_of(poses)
    return ProcedureOutcome(
        kind=TOOL,
        record=result.to_record(),
        passed=result.passed,
        warnings=(),
        picture_png=await cell.workers.run(tool_picture, result),
        serial_number="",
    )


def tool_of(poses: Sequence[RigidTransform]) -> ToolResult:
    """The tool from the poses of the flange at all touches, in their order.

    Raises ``PosesNotDiverse`` and ``IllConditioned``.
    """
    return calibrate_tool(poses[:TOUCHES], poses[TOUCHES:])


def what_is_wrong(pose: RigidTransform, before: Sequence[RigidTransform]) -> str:
    """Why a pose cannot be the touch that comes after those before; empty where it can."""
    if len(before) < TOUCHES:
        turns = [(other.rotation.inv() * pose.rotation).magnitude() for other in before]
        if turns and min(turns) < _ANEW_RAD:
            return (
                f"turned by {np.degrees(min(turns)):.0f}° against touch {int(np.argmin(turns)) + 1}"
            )
        return ""
    if len(before) == TOUCHES:
        return ""
    point = before[TOUCHES]
    turned = (point.rotation.inv() * pose.rotation).magnitude()
    if turned > STILL_RAD:
        return f"the flange was turned by {np.degrees(turned):.1f}°"
    way_m = float(np.linalg.norm(pose.translation - point.translation))
    if way_m < MIN_TRAVEL_M:
        return f"{way_m / MM:.0f} mm from the point, {MIN_TRAVEL_M / MM:.0f} needed"
    return ""
