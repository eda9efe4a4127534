"""Procedure 103: the main robot's base in the large-field head (paper 2.1.2, fig. 2)."""

import numpy as np

from cellctl.calibration.axis_fit import AxisStop
from cellctl.calibration.base_frame import ArmGeometry, calibrate_base_frame
from cellctl.calibration.base_frame_picture import base_frame_picture
from cellctl.geometry.pose import MM, Array
from cellctl.procedures.clear_cell import clear_the_cell
from cellctl.procedures.context import ProcedureContext, ProcedureOutcome
from cellctl.processes.deck_to_frame.taught_poses import main_to_home


async def calibrate_base(context: ProcedureContext) -> ProcedureOutcome:
    """Turn A1 alone, then A2 alone, and measure the flange's targets at every stop.

    From home, with both heads retracted; each turn is entered from the middle of its arc.
    """
    cell = context.cell
    settings, main = cell.config.procedures, cell.config.robots.main
    start_rad = np.radians(settings.base_frame_joints_deg)
    await clear_the_cell(context)
    a1_stops = await _turn(context, 0, start_rad)
    a2_stops = await _turn(context, 1, start_rad)
    await _move(context, start_rad)
    await main_to_home(cell)
    arm = ArmGeometry(d1_m=main.d1_mm * MM, a1_m=main.a1_mm * MM)
    result = await cell.workers.run(calibrate_base_frame, a1_stops, a2_stops, arm)
    return ProcedureOutcome(
        item="base_frame",
        record=result.to_record(),
        passed=result.passed,
        warnings=result.warnings,
        picture_png=await cell.workers.run(base_frame_picture, result),
        serial_number=await cell.tracker.serial_number(),
    )


def _angles(start_rad: Array, axis: int, arc_deg: float, stops: int) -> list[Array]:
    """Joint targets: one axis over its arc around the start, the others still."""
    targets = []
    for offset in np.radians(np.linspace(-arc_deg / 2, arc_deg / 2, stops)):
        joints_rad = start_rad.copy()
        joints_rad[axis] += offset
        targets.append(joints_rad)
    return targets


async def _turn(context: ProcedureContext, axis: int, start_rad: Array) -> list[AxisStop]:
    settings = context.cell.config.procedures
    targets = _angles(start_rad, axis, settings.circle_arc_deg, settings.circle_stops)
    await _move(context, start_rad)
    stops = []
    for number, joints_rad in enumerate(targets, start=1):
        await context.progress(number, len(targets), f"axis A{axis + 1}: stop")
        await _move(context, joints_rad)
        seen = await context.cell.tracker.measure(settings.tracker_frames)
        flange = tuple(target for target in seen if target.name.startswith("F"))
        stops.append(AxisStop(context.cell.main.state().joints_rad, flange))
    return stops


async def _move(context: ProcedureContext, joints_rad: Array) -> None:
    ratio = context.cell.config.robots.main.speed_percent / 100
    await context.cell.main.move_joint(joints_rad, speed_ratio=ratio)
