"""Moves to the beginning of a run, and off the station, go on a known straight way."""

import asyncio
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.config.devices import WayConfig
from cellctl.errors.force import GuardRefused, LiftOffHeld, NotSettled, SensorSilent
from cellctl.errors.robot import MotionRejected
from cellctl.force.contact.leaving import FIRST_LIFT_M
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.guard.settling import Settling
from cellctl.processes.deck_to_frame.moves.lift_off import (
    LIFT_M,
    NEAR_SPEED_M_S,
    SLOW_LIFT_M,
    first_lift_speed_m_s,
    lift_off,
)
from cellctl.processes.deck_to_frame.moves.taught_poses import (
    heads_to_measuring_poses,
    main_to_home,
)
from cellctl.processes.deck_to_frame.roles import DECK_MEASURE, HOME
from tests.unit.cell.bench import Bench


def lifts(bench: Bench) -> list[np.ndarray]:
    return [
        move.target.translation - bench.flange_over_seat(0.0).translation
        for move in bench.cell.main.moves
    ]


async def test_a_seated_deck_is_lifted_straight_and_slowly_at_first(bench: Bench) -> None:
    main = bench.cell.main
    main.flange = start = bench.flange_over_seat(0.0)
    await lift_off(bench.deck)
    assert [move.kind for move in main.moves] == ["linear"] * 3
    up_m = [[0, 0, FIRST_LIFT_M], [0, 0, SLOW_LIFT_M], [0, 0, LIFT_M]]
    np.testing.assert_allclose(lifts(bench), up_m, atol=1e-12)
    assert main.moves[0].speed < 0.1 * NEAR_SPEED_M_S
    assert main.moves[1].speed == NEAR_SPEED_M_S
    assert (start.rotation.inv() * main.flange.rotation).magnitude() < 1e-12


async def test_the_way_off_is_the_normal_of_the_frame_as_measured(bench: Bench) -> None:
    tilt = pose_from_xyzabc([3.0, -2.0, 0.0, 0.3, 0.1, -0.1])
    bench.memory.base_T_frame = bench.station * tilt
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    await lift_off(bench.deck)
    normal = bench.memory.base_T_frame.rotation.apply([0.0, 0.0, 1.0])
    np.testing.assert_allclose(lifts(bench)[-1], LIFT_M * normal, atol=1e-12)
    assert np.linalg.norm(lifts(bench)[-1][:2]) > 1e-4


async def test_a_frame_measured_elsewhere_is_not_believed(bench: Bench) -> None:
    bench.memory.base_T_frame = bench.station * pose_from_xyzabc([0, 0, 0, 0, 30.0, 0])
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    await lift_off(bench.deck)
    np.testing.assert_allclose(lifts(bench)[-1], [0, 0, LIFT_M], atol=1e-12)


@pytest.mark.parametrize(
    "elsewhere",
    [
        lambda bench: bench.flange_over_seat(0.05),
        lambda bench: RigidTransform.from_translation([0, 1.2, 0]) * bench.flange_over_seat(0.0),
    ],
)
async def test_nothing_moves_where_the_deck_is_clear(
    bench: Bench, elsewhere: Callable[[Bench], RigidTransform]
) -> None:
    bench.cell.main.flange = elsewhere(bench)
    await lift_off(bench.deck)
    assert bench.cell.main.moves == []


async def test_a_deck_beside_its_seat_is_lifted_too(bench: Bench) -> None:
    aside = RigidTransform.from_translation([0.0, 0.6, 0.0])
    bench.cell.main.flange = aside * bench.flange_over_seat(-0.01)
    await lift_off(bench.deck)
    assert len(bench.cell.main.moves) == 3


async def test_the_lift_is_watched_from_a_zero_taken_at_standstill(bench: Bench) -> None:
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    await lift_off(bench.deck)
    guard = bench.cell.guard
    watched = ["disarm", "set_wrench_frame", "tare", "arm", "disarm"]
    assert guard.asked == watched * 2, "again once the deck is free"
    mating = bench.recipe.mating
    assert guard.limits[0].filtered[:3] == pytest.approx((mating.limit_force_n,) * 3, abs=0.1)
    assert guard.limits[0].stale_s == bench.deck.force_config.stale_ms / 1e3


async def test_without_a_compensation_the_zero_alone_will_do(bench: Bench) -> None:
    bench.cell.guard.gravity_compensated = False
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    await lift_off(bench.deck)
    asked = bench.cell.guard.asked
    # Not while a guard that the last run has left armed would refuse it.
    assert asked[:2] == ["disarm", "set_gravity_compensation"]
    assert asked.index("set_gravity_compensation") < asked.index("arm")


@pytest.mark.parametrize(
    ("reason", "fault"),
    [(TripReason.FILTERED_LIMIT, LiftOffHeld), (TripReason.SENSOR_SILENT, SensorSilent)],
)
async def test_a_trip_while_lifting_stops_and_nothing_moves_on(
    bench: Bench, reason: TripReason, fault: type[Exception]
) -> None:
    main, guard = bench.cell.main, bench.cell.guard
    main.flange = bench.flange_over_seat(0.0)
    main.road_is_free = asyncio.Event()
    lifting = asyncio.create_task(main_to_home(bench.deck))
    await main.on_the_way.wait()
    assert bench.cell.awaits_trips("force")
    guard.trip = GuardTrip(reason, 1.0, "Fz -51.00 N, limit 50.00 N", 2)
    while not main.stops:  # noqa: ASYNC110 - the second stop, which ends the move
        await asyncio.sleep(0.001)
    main.road_is_free.set()
    with pytest.raises(fault, match="Fz -51"):
        await lifting
    assert len(main.moves) == 1
    assert main.latched
    assert guard.asked[-1] == "arm", "still watching"
    assert not bench.cell.awaits_trips("force")


async def test_a_guard_that_cannot_watch_keeps_the_deck_where_it_is(bench: Bench) -> None:
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    bench.cell.guard.faults["arm"] = GuardRefused("no fresh samples")
    with pytest.raises(GuardRefused):
        await lift_off(bench.deck)
    bench.cell.guard.settling = Settling(window_s=0.0, timeout_s=0.01, poll_s=0.0)
    bench.cell.guard.raw = np.random.default_rng(0).normal(0.0, 50.0, (200, 6))
    with pytest.raises(NotSettled):
        await lift_off(bench.deck)
    assert bench.cell.main.moves == []


def test_a_deck_that_is_held_is_pulled_by_twice_the_limit_at_most(bench: Bench) -> None:
    mating, force = bench.recipe.mating, bench.deck.force_config
    delay_s = (300.0 + force.stale_ms) / 1e3 + 5e-3
    speed_m_s = first_lift_speed_m_s(mating, force)
    stiffness_n_m = mating.stiffness_n_per_mm * 1e3
    assert stiffness_n_m * speed_m_s * delay_s == pytest.approx(mating.limit_force_n)


async def test_home_is_reached_off_the_station(bench: Bench) -> None:
    main = bench.cell.main
    main.flange = bench.flange_over_seat(0.0)
    await main_to_home(bench.deck)
    # To where the way home begins, by its via point, home.
    assert [move.kind for move in main.moves] == ["linear"] * 3 + ["joint"] * 3
    await main_to_home(bench.deck)
    assert len(main.moves) == 6, "there already"


async def test_a_stated_way_home_is_followed_from_the_station(bench: Bench) -> None:
    main, config = bench.cell.main, bench.deck.main_config
    via_deg = (-20.0, -71.0, 114.0, -27.0, 80.0, 90.0)
    way = WayConfig(start=DECK_MEASURE, end=HOME, via_deg=(via_deg,))
    arm = replace(bench.deck.arm, config=config.model_copy(update={"ways": (way,)}))
    main.flange = bench.flange_over_seat(0.0)
    await main_to_home(replace(bench.deck, arm=arm))
    assert [move.kind for move in main.moves] == ["linear"] * 3 + ["joint"] * 3
    expected_deg = [config.poses_deg[DECK_MEASURE], via_deg, config.poses_deg[HOME]]
    for move, joints_deg in zip(main.moves[3:], expected_deg, strict=True):
        np.testing.assert_allclose(np.degrees(move.target), joints_deg)


async def test_heads_in_place_do_not_move(bench: Bench) -> None:
    await heads_to_measuring_poses(bench.deck)
    assert [len(head.robot.moves) for head in bench.cell.heads] == [1, 1]  # type: ignore[attr-defined]
    await heads_to_measuring_poses(bench.deck)
    assert [len(head.robot.moves) for head in bench.cell.heads] == [1, 1]  # type: ignore[attr-defined]


async def test_a_head_that_is_off_by_a_hair_is_driven_back(bench: Bench) -> None:
    await heads_to_measuring_poses(bench.deck)
    bench.cell.aux_2.joints_rad = bench.cell.aux_2.joints_rad + np.radians(0.002)
    await heads_to_measuring_poses(bench.deck)
    assert [len(robot.moves) for robot in bench.cell.robots.values()] == [0, 1, 2]


async def test_one_head_that_refuses_stops_the_other(bench: Bench) -> None:
    bench.cell.aux_2.road_is_free = asyncio.Event()
    bench.cell.aux_1.faults["move"] = MotionRejected("aux_1")
    with pytest.raises(MotionRejected):
        await heads_to_measuring_poses(bench.deck)
    assert bench.cell.aux_2.stops == 1
    assert bench.cell.aux_2.latched
