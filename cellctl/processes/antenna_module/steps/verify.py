"""Step 90: pull at the plug, let the module go, and look whether it stayed."""

from collections.abc import Sequence

from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.faults.plugging import PlugNotHeld
from cellctl.processes.antenna_module.insertion.limits import InsertionPhase
from cellctl.processes.antenna_module.moves.places import raised
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt
from cellctl.processes.antenna_module.pushing.push_in import FINE_M
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import Inserted, Released
from cellctl.processes.antenna_module.steps.after_release import look_after_release
from cellctl.processes.antenna_module.steps.contact import contact
from cellctl.records.figures import Limit

PULL_SPEED_M_S = 0.2e-3
"""So slow that the pull grows in fine steps: a plug that does not hold is noticed before it is
out."""
_AXIAL = 2
"""Index of the force along the insertion axis."""
_ROUNDING_M = 1e-9
"""Rounding of a sum of fine steps: a last step as short as this would move nothing."""


async def verify(inserted: Inserted) -> Released:
    """Pull, release, leave, look.

    Raises ``PlugNotHeld`` or ``MovedOnRelease``, and ``PartLost`` for a module that the jaws do not
    hold: it stays where it is, for the operator.
    """
    run = inserted.run
    arm = run.cell.arm
    with run.cell.cell.trips_awaited(arm.sensor_name):
        async with contact(inserted) as attempt:
            limits = attempt.limits
            await attempt.arm(limits.at(limits.seat_depth_m))
            seated = attempt.way.pose_at(await _pull(run, attempt))
    await arm.guard.disarm()
    await run.cell.gripper.open()
    here = arm.robot.state().base_T_flange
    await run.mover.slowly_to(raised(here, run.recipe.insertion.retreat_mm * MM))
    seated_top_m = float(seated.translation[2]) + inserted.module.top_over_flange_m
    await look_after_release(inserted, seated_top_m)
    return Released(
        run,
        inserted.module,
        plug=inserted.plug,
        flange_T_connector=inserted.flange_T_connector,
        looks=inserted.looks,
        plan=inserted.plan,
        judgement=inserted.judgement,
    )


async def _pull(run: PluggingRun, attempt: PushAttempt) -> float:
    """Up in fine steps until the plug resists with the force of the test.

    The depth on the way at which it neither pressed nor pulled: where the arm holds it at its seat,
    and fingers and arm give way by nothing.
    """
    insertion = run.recipe.insertion
    assert attempt.limits.phase_at(attempt.depth_m) is InsertionPhase.SLIDING
    wanted_n, most_m = insertion.pull_n, insertion.pull_travel_mm * MM
    begin_m = attempt.depth_m
    readings = [(begin_m, float((await attempt.read())[_AXIAL]))]
    pulled_m, pull_n = 0.0, 0.0
    while pull_n < wanted_n and pulled_m < most_m - _ROUNDING_M:
        pulled_m = min(pulled_m + FINE_M, most_m)
        pose = attempt.way.pose_at(begin_m - pulled_m)
        trip = await attempt.move(attempt.robot.step(pose, speed_m_s=PULL_SPEED_M_S))
        if trip is not None:
            raise trip.fault()
        readings.append((attempt.depth_m, float((await attempt.read())[_AXIAL])))
        pull_n = -readings[-1][1]
    await run.recorder.figure(keys.PULL_TRAVEL, pulled_m / MM, "mm", limit=Limit(upper=most_m / MM))
    await run.recorder.figure(keys.PULL, pull_n, "N", limit=Limit(lower=wanted_n))
    # Jaws that have lost the module meet no resistance either.
    await run.cell.gripper.confirm_part()
    if pull_n < wanted_n:
        raise PlugNotHeld(f"{pull_n:.1f} N after {pulled_m / MM:.2f} mm, wanted {wanted_n:g} N")
    return free_depth_m(readings)


def free_depth_m(readings: Sequence[tuple[float, float]]) -> float:
    """Depth (m) at which the axial force (N) of successive readings first came down to nothing."""
    (depth_m, force_n), *rest = readings
    for next_m, next_n in rest:
        if force_n <= 0.0:
            break
        if next_n <= 0.0:
            share = force_n / (force_n - next_n)
            return depth_m + share * (next_m - depth_m)
        depth_m, force_n = next_m, next_n
    return depth_m
