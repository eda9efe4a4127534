"""Reset lifts a deck off its seat under the guard; what holds it is a fault, and it stays."""

import asyncio
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from cellctl.cell.lighting.auto_exposure import RunExposures
from cellctl.daemon.supervision import LinkMonitor
from cellctl.errors.force import LiftOffHeld, NotSettled
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.processes.deck_to_frame.calibrations import PAYLOAD
from cellctl.processes.deck_to_frame.moves.lift_off import lift_off
from cellctl.processes.deck_to_frame.moves.move_to_start import move_to_start
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.run import OpenRun
from cellctl.records.run_recorder import RunRecorder
from cellctl.runtime.progress import ProgressBoard
from tests.unit.cell.bench import Bench
from tests.unit.daemon_rig import DaemonRig

HELD = GuardTrip(TripReason.FILTERED_LIMIT, 1.0, "Fz -50.30 N, limit 50.00 N", 2, -50.3)


def opened(bench: Bench, recipe: DeckRecipe) -> OpenRun:
    """A run that goes to its beginning, and does not come to be recorded."""
    found: Any = SimpleNamespace(
        facts=bench.facts(recipe=recipe),
        board=ProgressBoard(),
        exposures=RunExposures(bench.as_cell, cast(RunRecorder, None)),
    )
    return cast(OpenRun, found)


async def reset_while_it_is_held(daemon_rig: DaemonRig) -> None:
    main, guard = daemon_rig.bench.cell.main, daemon_rig.bench.cell.guard
    main.flange = daemon_rig.bench.flange_over_seat(0.0)
    main.road_is_free = asyncio.Event()
    watch = LinkMonitor(daemon_rig.bench.as_cell, daemon_rig.unit)
    assert await daemon_rig.take(Command.RESET) is RejectCode.NONE
    await main.on_the_way.wait()
    guard.trip = HELD
    await watch.look()
    await daemon_rig.until(lambda: main.stops > 0)
    main.road_is_free.set()
    await daemon_rig.to(State.ABORTED)
    await watch.look()


async def test_a_deck_that_is_held_ends_the_reset_with_one_fault(daemon_rig: DaemonRig) -> None:
    await reset_while_it_is_held(daemon_rig)
    main = daemon_rig.bench.cell.main
    assert [type(fault) for fault in daemon_rig.unit.machine.faults] == [LiftOffHeld]
    assert daemon_rig.unit.alarms.numbers == (LiftOffHeld.number,)
    assert len(main.moves) == 1
    assert main.latched


async def test_after_clear_and_reset_it_goes_on_from_a_new_zero(daemon_rig: DaemonRig) -> None:
    await reset_while_it_is_held(daemon_rig)
    main, guard = daemon_rig.bench.cell.main, daemon_rig.bench.cell.guard
    main.road_is_free = None
    await daemon_rig.idle()
    assert guard.asked.count("tare") == 3, "pressed, and after the new start pressed and free"
    assert len(main.moves) == 4


@pytest.mark.parametrize(
    ("along_n", "may_n"), [(35.0, 50.0), (0.0, 50.0), (-30.0, 20.0)], ids=["pressed", "", "pulled"]
)
async def test_a_deck_that_is_pulled_already_is_pulled_by_the_less(
    bench: Bench, along_n: float, may_n: float
) -> None:
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    guard = bench.cell.guard
    guard.raw = guard.raw * 0.05 + np.array([0.0, 0.0, along_n, 0.0, 0.0, 0.0])
    bench.cell.main.road_is_free = asyncio.Event()
    lifting = asyncio.create_task(lift_off(bench.deck))
    await bench.cell.main.on_the_way.wait()
    # From the new zero the deck that comes free changes the force by what was on it.
    guard.raw = guard.raw - np.array([0.0, 0.0, 2.0 * along_n, 0.0, 0.0, 0.0])
    bench.cell.main.road_is_free.set()
    await lifting
    first, second = guard.limits
    assert bench.recipe.mating.limit_force_n == 50.0
    assert first.filtered[2] == pytest.approx(may_n, abs=0.1)
    assert second.filtered[2] == pytest.approx(50.0, abs=0.1)


@pytest.mark.parametrize(
    ("ran", "may_n"), [(1, 50.0), (2, 20.0), (None, 20.0)], ids=["", "", "after a restart"]
)
async def test_a_deck_is_pulled_no_harder_than_its_own_recipe_allows(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, ran: int | None, may_n: float
) -> None:
    """Two products go to one station, and the harder one stands first in the cell file."""
    hard = bench.recipe
    mating = hard.mating.model_copy(update={"limit_force_n": 20.0})
    delicate = hard.model_copy(update={"id": 2, "mating": mating})
    both = bench.cell.config.model_copy(update={"recipes": (hard, delicate)})
    monkeypatch.setattr(bench.cell, "config", both)
    assert (hard.id, hard.mating.limit_force_n) == (1, 50.0)
    if ran is not None:
        recipe = cast(DeckRecipe, both.recipes[ran - 1])
        await move_to_start(opened(bench, recipe))
    bench.cell.guard.limits.clear()
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    await lift_off(bench.deck)
    assert [limits.filtered[0] for limits in bench.cell.guard.limits[:2]] == [may_n, may_n]


@pytest.mark.parametrize("hidden_n", [0.0, None], ids=["", "after a restart"])
async def test_a_pull_of_the_first_stretch_counts_in_the_rise(
    bench: Bench, hidden_n: float | None
) -> None:
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    guard = bench.cell.guard
    guard.raw, guard.hidden_axial_n = guard.raw * 0.05, hidden_n
    bench.cell.main.road_is_free = asyncio.Event()
    lifting = asyncio.create_task(lift_off(bench.deck))
    await bench.cell.main.on_the_way.wait()
    # Something yielding holds it: 40 N after 0.4 mm, of 50 N allowed.
    guard.raw = guard.raw - np.array([0.0, 0.0, 40.0, 0.0, 0.0, 0.0])
    bench.cell.main.road_is_free.set()
    await lifting
    _, rise = guard.limits
    # After a restart it may as well have been pressed by that.
    may_n = 10.0 if hidden_n is not None else 50.0
    assert rise.filtered[2] == pytest.approx(may_n, abs=0.1)
    told_n = guard.hidden_axial_n
    assert told_n == pytest.approx(may_n - 50.0, abs=0.1), "the next attempt knows it too"


async def test_a_deck_that_holds_a_full_pull_is_not_pulled_again(bench: Bench) -> None:
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    guard = bench.cell.guard
    guard.raw = guard.raw * 0.05 - np.array([0.0, 0.0, 52.0, 0.0, 0.0, 0.0])
    for _ in range(2):
        with pytest.raises(LiftOffHeld, match="pulled with 52 N already, allowed 50 N"):
            await lift_off(bench.deck)
    assert bench.cell.main.moves == []


@pytest.mark.parametrize(
    ("along_n", "may_n"),
    [(40.0, 50.0), (0.0, 50.0), (-75.0, 50.0), (-110.0, 20.0), (1800.0, 50.0)],
    ids=["pressed", "free", "within what a zero may be off", "pulled", "deck let go"],
)
@pytest.mark.parametrize("in_frame", [False, True], ids=["", "told of"])
async def test_after_a_restart_the_payload_tells_a_pull_that_the_guard_has_forgotten(
    bench: Bench, along_n: float, may_n: float, in_frame: bool
) -> None:
    payload = restarted(bench, along_n, in_frame=in_frame)
    await lift_off(bench.deck, payload)
    first, _ = bench.cell.guard.limits
    assert bench.recipe.mating.max_untared_force_n == 80.0
    assert first.filtered[2] == pytest.approx(may_n, abs=0.5)


@pytest.mark.parametrize("attempt", [1, 2])
async def test_a_held_deck_is_not_pulled_the_more_with_every_restart(
    bench: Bench, attempt: int
) -> None:
    for _ in range(attempt):
        payload = restarted(bench, -130.0)
        with pytest.raises(LiftOffHeld, match="pulled with 50 N already, allowed 50 N"):
            await lift_off(bench.deck, payload)
    assert bench.cell.main.moves == []


async def test_without_a_valid_payload_a_reset_lifts_all_the_same(daemon_rig: DaemonRig) -> None:
    bench = daemon_rig.bench
    restarted(bench, -130.0)
    bench.calibrations.invalidate([PAYLOAD], "another gripper")
    await daemon_rig.idle()
    first, _ = bench.cell.guard.limits
    assert first.filtered[2] == pytest.approx(50.0)


async def test_a_zero_that_is_known_counts_and_not_the_payload(bench: Bench) -> None:
    payload = restarted(bench, -130.0)
    guard = bench.cell.guard
    guard.in_part_frame, guard.hidden_axial_n = True, -guard.raw[:, 2].mean()
    await lift_off(bench.deck, payload)
    first, _ = guard.limits
    assert first.filtered[2] == pytest.approx(50.0, abs=0.5)


def restarted(bench: Bench, along_n: float, *, in_frame: bool = False) -> GravityCompensation:
    """A deck on its seat with this force along the approach, and a guard that knows no zero; the
    payload as it was identified."""
    main, guard = bench.cell.main, bench.cell.guard
    main.flange = bench.flange_over_seat(0.0)
    payload = bench.snapshot().get(PAYLOAD).gravity_compensation
    base_R_sensor = main.flange.rotation * bench.deck.arm.flange_T_sensor.rotation
    base_R_deck = (main.flange * bench.grip).rotation
    contact = base_R_sensor.inv().apply(base_R_deck.apply([0.0, 0.0, along_n]))
    noise = np.random.default_rng(1).normal(0.0, 0.05, (200, 6))
    guard.raw = noise + payload.load(base_R_sensor) + np.concatenate([contact, np.zeros(3)])
    guard.in_part_frame, guard.hidden_axial_n = in_frame, None
    return payload


async def test_a_load_that_swings_leaves_the_pull_known(bench: Bench) -> None:
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    guard = bench.cell.guard
    guard.raw, guard.hidden_axial_n = guard.raw * 0.05, -30.0
    guard.settling = replace(guard.settling, timeout_s=0.0)
    with pytest.raises(NotSettled):
        await lift_off(bench.deck)
    assert guard.hidden_axial_n == -30.0
    assert bench.cell.main.moves == []
