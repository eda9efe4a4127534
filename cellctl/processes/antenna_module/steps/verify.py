"""Step 90: pull at the plug, let the module go, and look whether it stayed."""

from functools import partial

import numpy as np

from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.faults.connector import ConnectorError
from cellctl.processes.antenna_module.faults.plugging import MovedOnRelease, PlugNotHeld
from cellctl.processes.antenna_module.insertion.limits import InsertionPhase
from cellctl.processes.antenna_module.looking import combined, plane_by
from cellctl.processes.antenna_module.mated import connector_T_plug
from cellctl.processes.antenna_module.moving import raised
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt
from cellctl.processes.antenna_module.pushing.push_in import FINE_M
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import Inserted, Released
from cellctl.processes.antenna_module.steps.contact import contact
from cellctl.processes.antenna_module.vision.measure import measure_marks
from cellctl.records.figures import Limit

PULL_SPEED_M_S = 0.2e-3
_AXIAL = 2


async def verify(inserted: Inserted) -> Released:
    """Pull, release, leave, look.

    Raises ``PlugNotHeld`` or ``MovedOnRelease``: the module stays where it is, for the operator.
    """
    run = inserted.run
    arm = run.cell.arm
    with run.cell.cell.trips_awaited(arm.sensor_name):
        async with contact(inserted) as attempt:
            limits = attempt.limits
            await attempt.arm(limits.at(limits.seat_depth_m))
            await _pull(run, attempt)
    await arm.guard.disarm()
    await run.cell.gripper.open()
    here = arm.robot.state().base_T_flange
    await run.mover.slowly_to(raised(here, run.recipe.insertion.retreat_mm * MM))
    await _look_after_release(inserted)
    return Released(
        run,
        inserted.module_kg,
        inserted.hanging_n,
        plug=inserted.plug,
        flange_T_connector=inserted.flange_T_connector,
        looks=inserted.looks,
        plan=inserted.plan,
        judgement=inserted.judgement,
    )


async def _pull(run: PluggingRun, attempt: PushAttempt) -> None:
    """Up in fine steps until the plug resists with the force of the test."""
    insertion = run.recipe.insertion
    assert attempt.limits.phase_at(attempt.depth_m) is InsertionPhase.SLIDING
    wanted_n, most_m = insertion.pull_n, insertion.pull_travel_mm * MM
    begin_m = attempt.depth_m
    pulled_m, pull_n = 0.0, 0.0
    while pull_n < wanted_n and pulled_m < most_m:
        pulled_m += FINE_M
        pose = attempt.way.pose_at(begin_m - pulled_m)
        trip = await attempt.move(attempt.robot.step(pose, speed_m_s=PULL_SPEED_M_S))
        if trip is not None:
            raise trip.fault()
        pull_n = -float((await attempt.read())[_AXIAL])
    await run.recorder.figure(keys.PULL_TRAVEL, pulled_m / MM, "mm", limit=Limit(upper=most_m / MM))
    await run.recorder.figure(keys.PULL, pull_n, "N", limit=Limit(lower=wanted_n))
    if pull_n < wanted_n:
        raise PlugNotHeld(f"{pull_n:.1f} N after {pulled_m / MM:.2f} mm, wanted {wanted_n:g} N")


async def _look_after_release(inserted: Inserted) -> None:
    """Camera I sees the top of the module where the plan has it."""
    run = inserted.run
    cam1 = run.facts.plug_cell.cam1.pose.pose
    socket = run.drawings.socket
    # By the looks and not by the plan: this camera has seen the socket, and sees the module now.
    connector_T_top = pose_from_xyzabc(run.recipe.plug_T_top)
    look = inserted.looks.sockets[-1]
    base_T_socket = look.base_T_flange * cam1 * look.camera_T_socket.pose
    base_T_top = base_T_socket * connector_T_plug(socket).inv() * connector_T_top
    # The top lies higher than the socket did: the camera goes up with it and keeps its distance.
    higher_m = float(base_T_top.translation[2] - base_T_socket.translation[2])
    target = raised(look.base_T_flange, higher_m)
    here = run.cell.arm.robot.state().base_T_flange
    climb_m = float(target.translation[2] - here.translation[2])
    await run.mover.to(raised(here, max(0.0, climb_m)))
    await run.mover.to(target)
    expected = (run.cell.arm.robot.state().base_T_flange * cam1).inv() * base_T_top
    measure = partial(
        measure_marks,
        camera=run.facts.camera_1,
        calibration=plane_by(run.facts.camera_1, expected, run.recipe.base_T_socket),
        marks=run.drawings.top,
    )
    try:
        seen = await run.eyes.look("released", run.cell.camera_1, measure)
    except ConnectorError as fault:
        raise MovedOnRelease(f"the module is not seen in its place: {fault}") from fault
    top = combined(tuple(marks.camera_T_marks for marks in seen.frames)).pose
    found = seen.base_T_flange * cam1 * top
    offset_m = float(np.linalg.norm((found.translation - base_T_top.translation)[:2]))
    limit_mm = run.recipe.seated_limit_mm
    await run.recorder.figure(keys.PLACED, offset_m / MM, "mm", limit=Limit(upper=limit_mm))
    if not offset_m <= limit_mm * MM:
        raise MovedOnRelease(f"{offset_m / MM:.3f} mm from its place, permitted {limit_mm:g} mm")
