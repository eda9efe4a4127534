"""Step 60: where the flange has to go, and how far the worst contact will be off."""

import numpy as np

from cellctl.clock import now_s
from cellctl.geometry.pose import MM, pose_error, pose_from_xyzabc
from cellctl.processes.antenna_module.chain.plan import (
    ContactPattern,
    PlugPlan,
    PlugTolerance,
    plan_plug,
)
from cellctl.processes.antenna_module.faults.plugging import PlanFarFromDrawing
from cellctl.processes.antenna_module.looking import nominal
from cellctl.processes.antenna_module.mated import connector_T_plug
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import Planned, SocketLocated
from cellctl.records.figures import Limit


async def plan(located: SocketLocated) -> Planned:
    """Compose the looks by the scheme of the recipe, and refuse what is too uncertain.

    Raises the faults of ``plan_plug`` and ``PlanFarFromDrawing``.
    """
    run = located.run
    socket = run.drawings.socket
    found = plan_plug(
        located.looks,
        run.facts.plug_cell,
        run.facts.scheme,
        # The chain's frame of the plug is that of the socket, so the contacts are the socket's.
        ContactPattern(socket.contacts, socket.positions_m),
        now_s=now_s(),
        correction=run.facts.correction,
        tolerance=PlugTolerance(run.recipe.worst_contact_mm * MM, run.recipe.max_age_s),
    )
    await _record(run, found)
    _require_near_drawing(run, found)
    return Planned(
        run,
        located.module,
        plug=located.plug,
        flange_T_connector=located.flange_T_connector,
        looks=located.looks,
        plan=found,
    )


def _require_near_drawing(run: PluggingRun, found: PlugPlan) -> None:
    """However looks and correction add up, the arm goes where the recipe has the socket."""
    place = run.recipe.base_T_socket
    flange_T_plug = pose_from_xyzabc(run.recipe.flange_T_plug) * connector_T_plug(
        run.drawings.socket
    )
    drawn = nominal(place) * flange_T_plug.inv()
    offset_m, turn_rad = pose_error(drawn, found.base_T_flange.pose)
    distance_m, angle_rad = float(np.linalg.norm(offset_m)), float(np.linalg.norm(turn_rad))
    gripper = run.drawings.gripper
    # A turned socket or plug swings the flange round the connector by its lever.
    lever_m = float(np.linalg.norm(flange_T_plug.translation))
    most_rad = np.radians(place.within_deg) + gripper.within_rad
    most_m = place.within_mm * MM + gripper.within_m + most_rad * lever_m
    if not (distance_m <= most_m and angle_rad <= most_rad):
        raise PlanFarFromDrawing(
            f"{distance_m / MM:.2f} mm and {np.degrees(angle_rad):.2f}° off, permitted are "
            f"{most_m / MM:.2f} mm and {np.degrees(most_rad):.2f}°"
        )


async def _record(run: PluggingRun, found: PlugPlan) -> None:
    await run.recorder.document(keys.PLAN, found.to_record())
    await run.recorder.measurement(keys.TARGET, "base", "flange", found.base_T_flange)
    await run.recorder.figure(
        keys.WORST_CONTACT,
        found.worst.p99_m / MM,
        "mm",
        limit=Limit(upper=run.recipe.worst_contact_mm),
    )
