"""Mating on simulated time: the fake cell's world and controller, the guard's real monitor."""

import asyncio
from dataclasses import dataclass, replace

import numpy as np
import pytest

from cellctl.errors.force import ContactPlanInvalid, NotSettled, TareImplausible
from cellctl.errors.line import LineLostInContact
from cellctl.force.contact.seat import SEAT_DEPTH_M
from cellctl.processes.deck_to_frame.faults import DeckNotSeated
from cellctl.processes.deck_to_frame.mating.commissioning import measure_contact_stiffness
from cellctl.processes.deck_to_frame.mating.mate import mate, mate_until_seated
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import (
    MatingOutcome,
    MatingPhase,
    MatingProgress,
    MatingResult,
)
from cellctl.runtime.interruption import Interruption
from tests.rigs.mating.cell import MatingCell
from tests.rigs.mating.simulated_loop import run_simulated
from tests.rigs.mating.trial import ARM_STIFFNESS_N_M, nominal_settings, plan_for

LATENCY_S = 0.25
SOON_S = 0.05
"""A robot that stops sooner may come down faster, which takes less time to compute."""


def cell_of(
    seed: int = 1, stiffness_n_m: float = 3e6, stop_latency_s: float = LATENCY_S
) -> MatingCell:
    return MatingCell.drawn(seed, stiffness_n_m=stiffness_n_m, stop_latency_s=stop_latency_s)


def mated(
    cell: MatingCell, plan: MatingPlan, seen: list[MatingProgress] | None = None
) -> MatingResult:
    told = seen if seen is not None else []

    async def attempt() -> MatingResult:
        return await mate(cell.robot, cell.guard, plan, told.append)

    result = run_simulated(cell.start_s, cell.advance, attempt)
    assert isinstance(result, MatingResult)
    return result


@dataclass(frozen=True)
class Seated:
    """One mating of a good deck, and what it told on the way."""

    cell: MatingCell
    plan: MatingPlan
    result: MatingResult
    seen: list[MatingProgress]


@pytest.fixture(
    scope="module",
    params=[
        pytest.param((1, 3e6), id="stiff"),
        # One mating, of some seconds, is what a standard run has the time for.
        pytest.param((2, 1e6), id="soft", marks=pytest.mark.long),
    ],
)
def seated(request: pytest.FixtureRequest) -> Seated:
    seed, stiffness_n_m = request.param
    cell = cell_of(seed, stiffness_n_m)
    plan = plan_for(cell, nominal_settings(LATENCY_S))
    seen: list[MatingProgress] = []
    return Seated(cell, plan, mated(cell, plan, seen), seen)


def test_a_good_deck_is_seated_below_the_limit(seated: Seated) -> None:
    payload, result, seen = seated.cell.world.payload, seated.result, seated.seen
    assert result.outcome is MatingOutcome.SEATED
    assert payload.peak_contact_force_n < 45.0
    assert 35.0 <= result.verdict.force_n <= 45.0
    # The gap is what travel and force say with the stiffness of this very contact. A deck that
    # bends meets the frame corner by corner, and a soft cell shows more of it.
    assert abs(result.verdict.gap_m) < 0.7 * SEAT_DEPTH_M
    assert result.released is not None
    assert 10.0 <= payload.contact_force_n <= 20.0, "relaxed for fastening"
    assert result.duration_s < 40.0
    phases = list(dict.fromkeys(progress.phase for progress in seen))
    assert phases == [
        MatingPhase.TARE,
        MatingPhase.FAST,
        MatingPhase.SLOW,
        MatingPhase.CREEP,
        MatingPhase.HOLD,
        MatingPhase.RELEASE,
        MatingPhase.ENDED,
    ]


@pytest.mark.long
@pytest.mark.parametrize(("target_n", "limit_n"), [(25.0, 40.0), (60.0, 80.0)])
def test_a_recipe_with_another_force_seats_too(target_n: float, limit_n: float) -> None:
    cell = cell_of(seed=6, stiffness_n_m=1e6)
    settings = replace(
        nominal_settings(LATENCY_S),
        target_force_n=target_n,
        limit_force_n=limit_n,
        abort_force_n=limit_n - 5.0,
    )
    result = mated(cell, plan_for(cell, settings))
    assert result.outcome is MatingOutcome.SEATED, result.verdict.findings
    assert target_n <= result.verdict.force_n
    assert cell.world.payload.peak_contact_force_n < limit_n


def test_the_record_holds_formula_curve_and_stiffness(seated: Seated) -> None:
    plan, result = seated.plan, seated.result
    assert result.speed.peak_n <= plan.settings.touch_peak_n + 1e-3
    assert result.curve.wrench.shape == (len(result.curve.time_s), 6)
    steps = np.diff(result.curve.time_s)
    assert steps.max() < 2e-3, "the curve has no gap"
    assert np.nanmax(result.curve.travel_m) <= plan.end_of_travel_m
    assert result.stiffness is not None
    arm_n_m, contact_n_m = ARM_STIFFNESS_N_M, seated.cell.world.scenario.contact.stiffness_n_m[0]
    truth_n_m = arm_n_m * contact_n_m / (arm_n_m + contact_n_m)
    # A burr carries first and is softer than the rim.
    assert result.stiffness.stiffness_n_m == pytest.approx(truth_n_m, rel=0.3)
    assert result.statistics.peak_filtered_fz_n < 45.0


def test_the_commanded_travel_never_passes_its_bound() -> None:
    cell = cell_of(seed=3, stop_latency_s=SOON_S)
    cell.world.faults.inject("no_frame")
    cell.world.rebuild()
    plan = plan_for(cell, nominal_settings(SOON_S))
    with pytest.raises(Exception, match="F523") as caught:
        mated(cell, plan)
    curve = caught.value.curve  # type: ignore[attr-defined]
    assert np.nanmax(curve.travel_m) <= plan.window.latest_m + 1e-6


@pytest.mark.long
def test_a_false_seat_is_measured_again_three_times() -> None:
    cell = cell_of(seed=4)
    cell.world.faults.inject("foreign_body", x_mm=0.0, y_mm=0.0, height_mm=0.2)
    cell.world.rebuild()
    settings = replace(nominal_settings(LATENCY_S), least_window_m=3e-4)
    first = plan_for(cell, settings)
    asked: list[int] = []

    async def measured(attempt: int) -> MatingPlan:
        asked.append(attempt)
        await cell.robot.move_linear(first.base_T_flange, speed_m_s=5e-3, acceleration_m_s2=0.05)
        return first

    async def attempts() -> MatingResult:
        return await mate_until_seated(cell.robot, cell.guard, measured, lambda _: None)

    with pytest.raises(DeckNotSeated, match="3 attempts") as caught:
        run_simulated(cell.start_s, cell.advance, attempts)
    assert asked == [1, 2, 3]
    assert caught.value.curve is not None
    assert cell.world.payload.peak_contact_force_n < 50.0
    assert cell.world.payload.contact_force_n == 0.0, "backed off"


def test_a_robot_that_is_not_at_the_stand_off_does_not_move() -> None:
    cell = cell_of()
    plan = plan_for(cell, nominal_settings(LATENCY_S))
    elsewhere = replace(plan, base_T_flange=plan.pose_at(-1e-3))
    with pytest.raises(ContactPlanInvalid, match=r"1\.000 mm"):
        mated(cell, elsewhere)
    assert cell.arm.encoder_pose(cell.world.time_s).translation == pytest.approx(
        plan.base_T_flange.translation
    )


def test_an_unsteady_or_implausible_wrench_is_not_tared() -> None:
    cell = cell_of()
    nervous = replace(nominal_settings(LATENCY_S), settle_sigma=(0.1, 0.1), settle_timeout_s=1.0)
    with pytest.raises(NotSettled, match="scatters"):
        mated(cell, plan_for(cell, nervous))
    strict = replace(nominal_settings(LATENCY_S), plausible=(1e-3, 1e-3))
    cell = cell_of()
    with pytest.raises(TareImplausible, match="compensation leaves"):
        mated(cell, plan_for(cell, strict))


def test_cancelling_stops_the_robot() -> None:
    cell = cell_of()
    plan = plan_for(cell, nominal_settings(LATENCY_S))

    async def cancelled() -> None:
        slow = asyncio.Event()

        def report(progress: MatingProgress) -> None:
            if progress.phase is MatingPhase.SLOW:
                slow.set()

        task = asyncio.create_task(mate(cell.robot, cell.guard, plan, report))
        await slow.wait()
        await asyncio.sleep(0.2)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task

    run_simulated(cell.start_s, cell.advance, cancelled)
    assert cell.controller.latched
    assert not cell.arm.moving(cell.world.time_s)


@pytest.mark.parametrize(
    ("phase", "stop_latency_s"),
    [
        (MatingPhase.CREEP, SOON_S),
        pytest.param(MatingPhase.HOLD, LATENCY_S, marks=pytest.mark.long),
    ],
)
def test_an_interruption_stops_the_robot_and_leaves_the_contact(
    phase: MatingPhase, stop_latency_s: float
) -> None:
    cell = cell_of(stop_latency_s=stop_latency_s)
    plan = plan_for(cell, nominal_settings(stop_latency_s))
    lost = LineLostInContact("mate")

    async def interrupted() -> float:
        interruption = Interruption()

        def report(progress: MatingProgress) -> None:
            if progress.phase is phase and cell.world.payload.contact_force_n > 0.0:
                interruption.interrupt(lost)

        with pytest.raises(LineLostInContact):
            await mate(cell.robot, cell.guard, plan, report, interruption)
        return plan.travel_of(cell.robot.reported)

    travel_m = run_simulated(cell.start_s, cell.advance, interrupted)
    assert not cell.arm.moving(cell.world.time_s)
    assert cell.world.payload.contact_force_n == 0.0
    backed_off_m = plan.window.expected_m - travel_m
    assert backed_off_m == pytest.approx(plan.settings.back_off_m, abs=1e-4)
    assert not hasattr(lost, "__notes__")


@pytest.mark.long
def test_contact_stiffness_is_measured_by_touching() -> None:
    cell = cell_of(seed=5, stiffness_n_m=2e6)
    plan = plan_for(cell, nominal_settings(LATENCY_S))

    async def measure() -> object:
        return await measure_contact_stiffness(
            cell.robot, cell.guard, plan, lambda _: None, contacts=2
        )

    found = run_simulated(cell.start_s, cell.advance, measure)
    assert 3e5 < found.estimate.stiffness_n_m < 9e5
    assert found.estimate.upper_n_m > 1e6 * 2e6 / 3e6 * 0.8
    assert len(found.contacts) == len(found.single) == 2
    assert plan.travel_of(cell.robot.reported) < 1e-4, "back at the stand-off"
