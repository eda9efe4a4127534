"""To the beginning of a run, and off the station, always on a known straight way."""

import asyncio
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.robot import MotionRejected
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.steps.positions import (
    LIFT_M,
    SLOW_LIFT_M,
    SLOW_SPEED_M_S,
    heads_to_measuring_poses,
    lift_off,
    main_to_home,
)
from tests.unit.cell.bench import Bench


def lifts(bench: Bench) -> list[np.ndarray]:
    return [
        move.target.translation - bench.flange_over_seat(0.0).translation
        for move in bench.cell.main.moves
    ]


async def test_a_seated_deck_is_lifted_straight_and_slowly_at_first(bench: Bench) -> None:
    main = bench.cell.main
    main.flange = start = bench.flange_over_seat(0.0)
    await lift_off(bench.as_cell)
    assert [move.kind for move in main.moves] == ["linear", "linear"]
    np.testing.assert_allclose(lifts(bench), [[0, 0, SLOW_LIFT_M], [0, 0, LIFT_M]], atol=1e-12)
    assert main.moves[0].speed == SLOW_SPEED_M_S
    assert (start.rotation.inv() * main.flange.rotation).magnitude() < 1e-12


async def test_the_way_off_is_the_normal_of_the_frame_as_measured(bench: Bench) -> None:
    tilt = pose_from_xyzabc([3.0, -2.0, 0.0, 0.3, 0.1, -0.1])
    bench.cell.base_T_frame = bench.station * tilt
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    await lift_off(bench.as_cell)
    normal = bench.cell.base_T_frame.rotation.apply([0.0, 0.0, 1.0])
    np.testing.assert_allclose(lifts(bench)[1], LIFT_M * normal, atol=1e-12)
    assert np.linalg.norm(lifts(bench)[1][:2]) > 1e-4


async def test_a_frame_measured_elsewhere_is_not_believed(bench: Bench) -> None:
    bench.cell.base_T_frame = bench.station * pose_from_xyzabc([0, 0, 0, 0, 30.0, 0])
    bench.cell.main.flange = bench.flange_over_seat(0.0)
    await lift_off(bench.as_cell)
    np.testing.assert_allclose(lifts(bench)[1], [0, 0, LIFT_M], atol=1e-12)


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
    await lift_off(bench.as_cell)
    assert bench.cell.main.moves == []


async def test_a_deck_beside_its_seat_is_lifted_too(bench: Bench) -> None:
    aside = RigidTransform.from_translation([0.0, 0.6, 0.0])
    bench.cell.main.flange = aside * bench.flange_over_seat(-0.01)
    await lift_off(bench.as_cell)
    assert len(bench.cell.main.moves) == 2


async def test_home_is_reached_off_the_station(bench: Bench) -> None:
    main = bench.cell.main
    main.flange = bench.flange_over_seat(0.0)
    await main_to_home(bench.as_cell)
    assert [move.kind for move in main.moves] == ["linear", "linear", "joint"]
    await main_to_home(bench.as_cell)
    assert len(main.moves) == 3, "there already"


async def test_heads_in_place_do_not_move(bench: Bench) -> None:
    await heads_to_measuring_poses(bench.as_cell)
    assert [len(head.robot.moves) for head in bench.cell.heads] == [1, 1]  # type: ignore[attr-defined]
    await heads_to_measuring_poses(bench.as_cell)
    assert [len(head.robot.moves) for head in bench.cell.heads] == [1, 1]  # type: ignore[attr-defined]


async def test_a_head_that_is_off_by_a_hair_is_driven_back(bench: Bench) -> None:
    await heads_to_measuring_poses(bench.as_cell)
    bench.cell.aux_2.joints_rad = bench.cell.aux_2.joints_rad + np.radians(0.002)
    await heads_to_measuring_poses(bench.as_cell)
    assert [len(robot.moves) for robot in bench.cell.robots] == [0, 1, 2]


async def test_one_head_that_refuses_stops_the_other(bench: Bench) -> None:
    bench.cell.aux_2.road_is_free = asyncio.Event()
    bench.cell.aux_1.faults["move"] = MotionRejected("aux_1")
    with pytest.raises(MotionRejected):
        await heads_to_measuring_poses(bench.as_cell)
    assert bench.cell.aux_2.stops == 1
    assert bench.cell.aux_2.latched
