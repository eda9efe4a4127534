"""Plug and socket touch: what insertion and verification need of devices, way and limits."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import numpy as np

from cellctl.cell.guarded_motion.contact_recorder import ContactRecorder
from cellctl.cell.guarded_motion.guard_limits import Sensing
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits
from cellctl.processes.antenna_module.insertion.watch import InsertionWatch
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import OverSocket
from cellctl.processes.antenna_module.steps.stand_off import way_of

_TURNED_FORCE = 0.005
"""Angle (rad) by which crosstalk and mounting of a sensor turn the force that it reports. On the
lever from the sensor to the contacts that is a moment, and moves the centre of pressure."""


@asynccontextmanager
async def contact(over: OverSocket) -> AsyncIterator[PushAttempt]:
    """Everything that moves with limits along the way of the plan; recorded meanwhile."""
    run, way = over.run, way_of(over)
    arm, limits = run.cell.arm, limits_of(run)
    async with ContactRecorder(arm.robot, arm.guard, way.depth_of) as recorder:
        yield PushAttempt(
            arm.robot,
            arm.guard,
            Sensing.of(arm.sensor),
            way,
            run.drawings.socket,
            limits,
            InsertionWatch(limits),
            recorder,
        )


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
        early_touch_m=margin_m,
        seat_tolerance_m=insertion.seat_tolerance_mm * MM,
        lever_error_m=_TURNED_FORCE * lever_m,
    )
