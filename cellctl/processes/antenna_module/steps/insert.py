"""Step 80: into the socket under force limits that follow depth."""

from dataclasses import replace

import numpy as np

from cellctl import log
from cellctl.cell.contact_recorder import ContactRecorder
from cellctl.cell.guard_limits import Sensing
from cellctl.clock import now_s
from cellctl.errors import CellError
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.chain.requirements import require_fresh
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits
from cellctl.processes.antenna_module.insertion.verdict import (
    InsertionJudgement,
    judge_insertion,
)
from cellctl.processes.antenna_module.insertion.watch import InsertionWatch
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt
from cellctl.processes.antenna_module.pushing.back_out import back_out
from cellctl.processes.antenna_module.pushing.push_in import push_in
from cellctl.processes.antenna_module.record.insertion import record_curve, record_judgement
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import AtStandOff, Inserted
from cellctl.processes.antenna_module.steps.stand_off import way_of

_log = log.get(__name__)
_TURNED_FORCE = 0.005
"""Crosstalk and mounting of a force sensor turn the force that it reports by so much (rad). On the
lever from the sensor to the contacts that is a moment, and moves the centre of pressure."""


async def insert(over: AtStandOff) -> Inserted:
    """Push in and judge the curve; after any fault of the contact straight out again.

    There is no second try: a module that has met a force fault belongs into quarantine. Raises the
    ``PluggingError`` of what was met, ``StaleLook``, and the faults of guard, sensor and robot.
    """
    run = over.run
    # The looks were fresh when the plan was made; nobody knows how long the way here took.
    require_fresh(over.looks, now_s(), run.recipe.max_age_s)
    run.board.update(force_limit_n=limits_of(run).greatest_n)
    way = way_of(over)
    arm = run.cell.arm
    async with ContactRecorder(arm.robot, arm.guard, way.depth_of) as recorder:
        limits = limits_of(run)
        attempt = PushAttempt(
            arm.robot,
            arm.guard,
            Sensing.of(arm.sensor),
            way,
            run.drawings.socket,
            limits,
            InsertionWatch(limits),
            recorder,
        )
        judgement = await _pushed(run, attempt)
    return Inserted(
        run,
        over.module_kg,
        over.hanging_n,
        plug=over.plug,
        flange_T_connector=over.flange_T_connector,
        looks=over.looks,
        plan=over.plan,
        judgement=judgement,
    )


async def _pushed(run: PluggingRun, attempt: PushAttempt) -> InsertionJudgement:
    insertion = run.recipe.insertion
    step_m, stand_off_m = insertion.step_mm * MM, insertion.stand_off_mm * MM
    # A trip of the guard is what this step is made to find; supervision leaves it alone.
    with run.cell.cell.trips_awaited(run.cell.arm.sensor_name):
        try:
            await run.interruption.unless(push_in(attempt, step_m))
            judgement = await _judged(run, attempt)
        except BaseException as reason:
            # Only after faults. A Stop or an Abort cancels, and what is cancelled must not begin
            # another move.
            if isinstance(reason, CellError):
                await back_out(attempt, reason, stand_off_m)
            await _keep_curve(run, attempt, reason)
            raise
    await record_curve(run, attempt.curve())
    return judgement


async def _judged(run: PluggingRun, attempt: PushAttempt) -> InsertionJudgement:
    """The verdict of the whole curve; raises its fault."""
    judgement = judge_insertion(attempt.curve(), attempt.socket, attempt.limits)
    await record_judgement(run, judgement, attempt.limits)
    if judgement.fault is not None:
        raise judgement.fault
    return judgement


async def _keep_curve(run: PluggingRun, attempt: PushAttempt, reason: BaseException) -> None:
    """The curve of a contact that went wrong; a disk that fails must not hide what ended it."""
    try:
        await record_curve(run, attempt.curve())
    except CellError as second:
        reason.add_note(f"insertion curve not kept: {second}")
        _log.error("insertion curve not kept", fault=str(second))


def limits_of(run: PluggingRun) -> InsertionLimits:
    """Limits of the drawing; touch and springs may come earlier by what the heights are uncertain.

    A pin that stands on the face within that height of the springs would be taken for them, so the
    entry ends before the springs can begin.
    """
    insertion, place = run.recipe.insertion, run.recipe.base_T_socket
    flange_T_plug = pose_from_xyzabc(run.recipe.flange_T_plug)
    sensor_T_plug = run.cell.arm.flange_T_sensor.inv() * flange_T_plug
    lever_m = float(np.linalg.norm(sensor_T_plug.translation))
    sigma_mm = float(np.hypot(place.height_sigma_mm, run.recipe.plug_height_sigma_mm))
    margin_m = insertion.height_sigmas * sigma_mm * MM
    limits = InsertionLimits.of(run.drawings.socket)
    return replace(
        limits,
        spring_depth_m=limits.spring_depth_m - margin_m,
        entry_height_m=limits.entry_height_m + margin_m,
        seat_tolerance_m=insertion.seat_tolerance_mm * MM,
        centre_of_pressure_m=limits.centre_of_pressure_m + _TURNED_FORCE * lever_m,
    )
