"""Within step 90: camera I looks whether the released module is where the gripper has left it."""

from functools import partial

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, pose_error, pose_from_xyzabc
from cellctl.processes.antenna_module.faults.connector import ConnectorError
from cellctl.processes.antenna_module.faults.plugging import MovedOnRelease
from cellctl.processes.antenna_module.looking import Seen, combined, height_by_size, marks_by
from cellctl.processes.antenna_module.mated import connector_T_plug
from cellctl.processes.antenna_module.moves.places import raised
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import Inserted
from cellctl.processes.antenna_module.steps.look_again import SecondLook
from cellctl.processes.antenna_module.vision.measurement import MeasuredMarks
from cellctl.records.figures import Limit


async def look_after_release(inserted: Inserted, seated_top_m: float) -> None:
    """Judge offset, turn and gap of the module.

    ``seated_top_m`` is the height of its top along z of the base with the plug at its seat. Raises
    ``MovedOnRelease``.
    """
    run = inserted.run
    base_T_top = _expected_top(inserted)
    await _bring_camera_over(inserted, base_T_top)
    try:
        seen = await SecondLook(run).look("released", partial(_look, run, base_T_top))
    except ConnectorError as fault:
        raise MovedOnRelease(f"the module is not seen in its place: {fault}") from fault
    base_T_cam1 = run.facts.plug_cell.base_T_cam1(seen.base_T_flange)
    top = combined(tuple(marks.camera_T_marks for marks in seen.frames)).pose
    found, height_m = base_T_cam1 * top, height_by_size(base_T_cam1, seen.frames)
    offset_m = float(np.linalg.norm((found.translation - base_T_top.translation)[:2]))
    turn_deg = float(np.degrees(pose_error(base_T_top, found)[1][2]))
    gap_mm = (height_m - seated_top_m) / MM - run.recipe.gap_zero_mm
    await _judge(run, offset_m / MM, turn_deg, gap_mm)


def _expected_top(inserted: Inserted) -> RigidTransform:
    """``base_T_top`` by the looks and not by the plan: this camera has seen the socket, and sees
    the module now."""
    run, socket = inserted.run, inserted.run.drawings.socket
    look = inserted.looks.sockets[-1]
    base_T_socket = run.facts.plug_cell.base_T_cam1(look.base_T_flange) * look.camera_T_socket.pose
    return base_T_socket * connector_T_plug(socket).inv() * pose_from_xyzabc(run.recipe.plug_T_top)


async def _bring_camera_over(inserted: Inserted, base_T_top: RigidTransform) -> None:
    """Move to where the socket was seen from, and higher by as much as the top lies over the
    socket: the camera keeps its distance."""
    run, look = inserted.run, inserted.looks.sockets[-1]
    base_T_cam1 = run.facts.plug_cell.base_T_cam1(look.base_T_flange)
    socket_m = (base_T_cam1 * look.camera_T_socket.pose).translation
    target = raised(look.base_T_flange, float(base_T_top.translation[2] - socket_m[2]))
    here = run.cell.arm.robot.state().base_T_flange
    climb_m = float(target.translation[2] - here.translation[2])
    await run.mover.to(raised(here, max(0.0, climb_m)))
    await run.mover.to(target)


async def _look(run: PluggingRun, base_T_top: RigidTransform, images: str) -> Seen[MeasuredMarks]:
    base_T_cam1 = run.facts.plug_cell.base_T_cam1(run.cell.arm.robot.state().base_T_flange)
    expected = base_T_cam1.inv() * base_T_top
    measure = marks_by(run.facts.camera_1, run.drawings.top, expected, run.recipe.base_T_socket)
    return await run.eyes.look(images, run.cell.camera_1, measure)


async def _judge(run: PluggingRun, offset_mm: float, turn_deg: float, gap_mm: float) -> None:
    """Record all of them, then raise for the first one that is beyond its limit."""
    most_mm, most_deg, most_gap_mm = (
        run.recipe.seated_limit_mm,
        run.recipe.seated_limit_deg,
        run.recipe.gap_limit_mm,
    )
    figure = run.recorder.figure
    await figure(keys.PLACED, offset_mm, "mm", limit=Limit(upper=most_mm))
    await figure(keys.PLACED_TURN, turn_deg, "°", limit=Limit(-most_deg, most_deg))
    await figure(keys.GAP, gap_mm, "mm", limit=Limit(-most_gap_mm, most_gap_mm))
    if not offset_mm <= most_mm:
        raise MovedOnRelease(f"{offset_mm:.3f} mm from its place, permitted {most_mm:g} mm")
    if not abs(turn_deg) <= most_deg:
        raise MovedOnRelease(f"turned by {turn_deg:+.2f}°, permitted {most_deg:g}°")
    # Below its seat a module cannot be: then what was measured is wrong.
    if not abs(gap_mm) <= most_gap_mm:
        raise MovedOnRelease(f"{gap_mm:+.3f} mm over its seat, permitted {most_gap_mm:g} mm")
