"""Procedure 208: the tool by touches, four points and three points, jogged by somebody.

The tip of the gripper is brought to one fixed point in several orientations of the flange, which
gives its place; then in one orientation to that point, along its x axis, and to the side of its y
axis, which gives its axes. Each touch ends with the key back on remote.
"""

from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.tool.tool import calibrate_tool
from cellctl.calibration.solvers.tool.tool_picture import tool_picture
from cellctl.cell.guarded_motion.settling import settle
from cellctl.processes.antenna_module.calibrations import TOOL
from cellctl.processes.antenna_module.faults.calibration import NobodyTouched
from cellctl.processes.antenna_module.procedures.by_hand import PATIENCE, Patience, jogged_by_hand
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome

TOUCHES = 8
"""Tilted by 45° in four directions, at two turns about the tip's axis 90° apart: so the tip is
determined alike in all directions."""
ORIENTING = ("tip on the point", "tip along its x axis", "tip to the side of its y axis")


async def touch_tool_on_cell(
    cell: AntennaCell, context: ProcedureContext, patience: Patience = PATIENCE
) -> ProcedureOutcome:
    """Collect the poses of all touches and solve; the arm is moved by the operator alone.

    Raises ``NobodyTouched``, ``PosesNotDiverse``, ``IllConditioned`` and ``NotSettled``.
    """
    total = TOUCHES + len(ORIENTING)
    poses: list[RigidTransform] = []
    for what in ("tip on the point, tilted anew",) * TOUCHES + ORIENTING:
        await context.progress(len(poses) + 1, total, f"by hand: {what},")
        await jogged_by_hand(cell.arm.robot, NobodyTouched, patience)
        await settle(cell.arm.guard)
        poses.append(cell.arm.robot.state().base_T_flange)
    result = calibrate_tool(poses[:TOUCHES], poses[TOUCHES:])
    return ProcedureOutcome(
        kind=TOOL,
        record=result.to_record(),
        passed=result.passed,
        warnings=(),
        picture_png=await cell.workers.run(tool_picture, result),
        serial_number="",
    )
