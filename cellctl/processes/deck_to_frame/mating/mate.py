"""Mating under force (paper 2.4.2, mission A4): from the stand-off to a judged seat."""

from collections.abc import Awaitable, Callable

from cellctl import log
from cellctl.cell.guarded_motion.contact_recorder import ContactRecorder
from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.errors.base import CellError
from cellctl.force.contact.commissioning import StiffnessEstimate
from cellctl.force.contact.curve import curve_statistics
from cellctl.force.contact.seat import SeatVerdict
from cellctl.interfaces import Robot
from cellctl.processes.deck_to_frame.faults import DeckNotSeated
from cellctl.processes.deck_to_frame.mating.attempt import Attempt, Report, loop_time_s
from cellctl.processes.deck_to_frame.mating.back_off import back_off
from cellctl.processes.deck_to_frame.mating.phases import (
    require_stand_off,
    settle_and_tare,
    take_over,
    travel_clear,
    travel_to_touch,
)
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import (
    MatingOutcome,
    MatingPhase,
    MatingProgress,
    MatingResult,
    Reading,
)
from cellctl.processes.deck_to_frame.mating.retreat import retreat
from cellctl.processes.deck_to_frame.mating.seating import creep_to, hold, stiffness_of
from cellctl.runtime.interruption import Interruption

_log = log.get(__name__)


async def mate(
    robot: Robot,
    guard: GuardPort,
    plan: MatingPlan,
    report: Report,
    interruption: Interruption | None = None,
) -> MatingResult:
    """One attempt: settle, tare, travel, touch, creep, hold, judge, relax.

    Starts at the stand-off of the plan with both latches released. A seat that is not one comes
    back as ``MatingOutcome.FALSE_SEAT`` with the arm backed off: measure again before the next
    attempt. Any violation stops the robot, backs off where that is right (``retreat``) and raises
    its own fault; a ``ForceError`` carries the force curve, and ``report`` gets it in any case.
    An ``interruption`` ends it like a violation, without one only cancelling does.
    """
    # Before the recorder and outside of ``try``: an arm that stands elsewhere has no contact from
    # which it could retreat.
    require_stand_off(robot, plan)
    async with ContactRecorder(robot, guard, plan.travel_of) as recorder:
        attempt = Attempt(robot, guard, plan, recorder, report)
        try:
            return await (interruption or Interruption()).unless(_run(attempt))
        except CellError as fault:
            # Only after faults. A Stop or an Abort cancels, and what is cancelled must not begin
            # another move.
            await retreat(attempt, fault)
            raise
        finally:
            report(_ended(recorder))


async def mate_until_seated(
    robot: Robot,
    guard: GuardPort,
    measured_plan: Callable[[int], Awaitable[MatingPlan]],
    report: Report,
    *,
    max_tries: int = 3,
    interruption: Interruption | None = None,
) -> MatingResult:
    """Attempts with a fresh measurement before each, until the deck is seated.

    ``measured_plan(n)`` is called before attempt n = 1, 2, …; it measures, corrects, and leaves
    the robot at the stand-off. Raises ``DeckNotSeated`` after ``max_tries``, and whatever ``mate``
    raises.
    """
    for number in range(1, max_tries + 1):
        result = await mate(robot, guard, await measured_plan(number), report, interruption)
        if result.outcome is MatingOutcome.SEATED:
            return result
        _log.warning("false seat", attempt=number, gap_mm=result.verdict.gap_m * 1e3)
    raise DeckNotSeated(
        f"{max_tries} attempts, the last {result.verdict.gap_m * 1e3:.3f} mm above the seat at "
        f"{result.verdict.force_n:.1f} N",
        result.curve,
    )


async def _run(attempt: Attempt) -> MatingResult:
    plan = attempt.plan
    begin_s = loop_time_s()
    tare = await settle_and_tare(attempt)
    await travel_clear(attempt)
    touch_travel_m = await travel_to_touch(attempt)
    await take_over(attempt)
    readings = await creep_to(attempt, plan.creep, MatingPhase.CREEP)
    held, verdict = await hold(attempt, readings)
    relaxing = await _leave(attempt, held, verdict, stiffness_of(readings))
    curve = attempt.recorder.curve()
    return MatingResult(
        outcome=MatingOutcome.SEATED if verdict.seated else MatingOutcome.FALSE_SEAT,
        window=plan.window,
        speed=plan.speed,
        segment_m=plan.segment_m,
        tare=tare,
        touch_travel_m=touch_travel_m,
        # The first reading of the creep is the one after the touch stop.
        touch_force_n=readings[0].force_n,
        creep=readings,
        # With the readings of relaxing: they reach down to 10 N and lengthen the line.
        stiffness=stiffness_of((*readings, *relaxing)),
        hold=held,
        verdict=verdict,
        relaxing=relaxing,
        gave_way=tuple(attempt.gave_way),
        curve=curve,
        statistics=curve_statistics(curve.time_s, curve.wrench),
        duration_s=loop_time_s() - begin_s,
    )


async def _leave(
    attempt: Attempt, held: Reading, verdict: SeatVerdict, stiffness: StiffnessEstimate | None
) -> tuple[Reading, ...]:
    """Relax a good seat for fastening, back off from a false one; readings while relaxing."""
    if not verdict.seated:
        await back_off(attempt)
        return ()
    shown_n_m = stiffness.stiffness_n_m if stiffness else None
    law = attempt.plan.release
    readings = await creep_to(attempt, law, MatingPhase.RELEASE, held, shown_n_m)
    await attempt.guard.disarm()
    return readings


def _ended(recorder: ContactRecorder) -> MatingProgress:
    curve = recorder.curve()
    travel_m = float(curve.travel_m[-1]) if len(curve.travel_m) else float("nan")
    force_n = float(curve.wrench[-1, 2]) if len(curve.wrench) else float("nan")
    return MatingProgress(MatingPhase.ENDED, travel_m, force_n, curve=curve)
