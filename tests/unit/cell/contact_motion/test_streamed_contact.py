import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import ContactMotion, Ended
from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.errors.force import ForceLimitExceeded
from cellctl.errors.streamed_contact import ContactLost, StreamLate
from cellctl.force.contact.streamed.gains import LoopFigures
from tests.unit.cell.contact_motion.elastic_world import ElasticWorld, Hole, Ticks, contact, wall

DOWN = np.array([0.0, 0.0, 1.0])
UPRIGHT = np.zeros(3)
CLOSE = np.array([0.0, 0.0, -0.05e-3, 0.0, 0.0, 0.0])


def run(motion: Coroutine[Any, Any, ContactMotion]) -> ContactMotion:
    ended: ContactMotion = asyncio.run(motion)
    return ended


@pytest.mark.parametrize("stiffness_n_m", [1e5, 1e6, 3e6])
def test_a_touch_ends_by_its_force_and_overshoots_by_no_more(stiffness_n_m: float) -> None:
    world = ElasticWorld(wall(stiffness_n_m), sigma_n=0.3, tip=CLOSE)
    motions = contact(world, LoopFigures(stiffness_n_m, world.dead_time_s))

    async def touch_and_stand() -> ContactMotion:
        touched = await motions.touch(DOWN, 1e-3, 8.0)
        await motions.touch(DOWN, 0.0, 100.0)
        return touched

    touched = run(touch_and_stand())
    assert touched.ended is Ended.FORCE
    assert -min(force[2] for force in world.forces) < 2 * 8.0


def test_a_touch_without_a_part_ends_by_its_travel() -> None:
    world = ElasticWorld(lambda _tip: np.zeros(6))
    touched = run(contact(world).touch(DOWN, 0.5e-3, 8.0))
    assert touched.ended is Ended.TRAVEL
    assert world.sent[-1][2] == pytest.approx(-0.5e-3, abs=1e-9)


def test_a_press_comes_to_its_force_without_a_jump_and_ends_by_its_time() -> None:
    world = ElasticWorld(wall(1e6), sigma_n=0.3, tip=CLOSE)
    motions = contact(world)

    async def touch_and_press() -> ContactMotion:
        await motions.touch(DOWN, 2e-3, 3.0)
        return await motions.press(8.0, 2.0)

    pressed = run(touch_and_press())
    assert pressed.ended is Ended.TIME
    assert -np.mean([force[2] for force in world.forces[-100:]]) == pytest.approx(8.0, abs=0.3)
    steps = np.abs(np.diff([tip[2] for tip in world.sent]))
    assert steps.max() < 0.01e-3
    assert -min(force[2] for force in world.forces) < 8.0 * 1.25


def test_a_press_into_nothing_is_a_lost_contact() -> None:
    world = ElasticWorld(lambda _tip: np.zeros(6))
    with pytest.raises(ContactLost, match=r"F587.*mm without the force"):
        run(contact(world).press(8.0, 60.0))


def test_a_slide_follows_its_points_under_a_steady_force() -> None:
    world = ElasticWorld(wall(1e6), sigma_n=0.3, tip=CLOSE)
    motions = contact(world)
    angle = np.linspace(0.0, 2 * np.pi, 30)
    way = 1e-3 * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    async def touch_and_slide() -> ContactMotion:
        await motions.touch(DOWN, 2e-3, 3.0)
        await motions.press(8.0, 1.0)
        return await motions.slide(way, 8.0, 3e-3, lambda _sample: False, 10.0)

    slid = run(touch_and_slide())
    assert slid.ended is Ended.TRAVEL
    assert np.allclose(world.sent[-1][:2], way[-1], atol=1e-9)
    assert np.allclose([sample.force_n[2] for sample in slid.samples], -8.0, atol=2.0)


def test_a_slide_that_falls_into_a_hole_ends_by_its_condition() -> None:
    hole = Hole(1e6, centre_m=np.array([1e-3, 0.0]))
    world = ElasticWorld(hole, sigma_n=0.3, tip=CLOSE)
    motions = contact(world)

    async def search() -> ContactMotion:
        await motions.touch(DOWN, 2e-3, 3.0)
        await motions.press(8.0, 0.5)
        way = np.array([[3e-3, 0.0]])
        return await motions.slide(way, 8.0, 2e-3, lambda s: s.force_n[2] > -2.4, 10.0)

    found = run(search())
    assert found.ended is Ended.CONDITION
    assert 0.3e-3 < found.last.task_position_tip_m[0] < 1.3e-3


@pytest.mark.parametrize(
    ("stiffness_n_m", "limit_s"),
    [(1e5, 10.0), pytest.param(1e6, 60.0, marks=pytest.mark.figures)],
)
def test_a_feed_gives_way_on_the_chamfer_and_ends_at_the_seat(
    stiffness_n_m: float, limit_s: float
) -> None:
    hole = Hole(stiffness_n_m, centre_m=np.array([0.3e-3, -0.2e-3]), depth_m=1.5e-3)
    world = ElasticWorld(hole, sigma_n=0.3, tip=CLOSE)
    motions = contact(world, LoopFigures(stiffness_n_m, world.dead_time_s))
    fed = run(motions.feed(hole.depth_m + 30.0 / stiffness_n_m + 0.3e-3, 30.0))
    assert fed.ended is Ended.FORCE
    last = fed.last
    yields_m = -last.force_n[2] / stiffness_n_m
    assert last.task_position_tip_m[2] - yields_m == pytest.approx(hole.depth_m, abs=0.02e-3)
    assert -last.force_n[2] == pytest.approx(18.0, abs=2.0)
    assert max(float(np.linalg.norm(force[:3])) for force in world.forces) < 30.0
    assert fed.last.time_s - fed.samples[0].time_s < limit_s


def test_it_comes_out_by_the_way_it_went_in() -> None:
    hole = Hole(1e5, centre_m=np.array([0.3e-3, 0.0]))
    world = ElasticWorld(hole)
    motions = contact(world, LoopFigures(1e5, world.dead_time_s))

    async def in_and_out() -> ContactMotion:
        await motions.feed(1.5e-3, 30.0)
        return await motions.back_out(2e-3)

    out = run(in_and_out())
    assert out.ended is Ended.TRAVEL
    assert world.sent[-1][2] == pytest.approx(-2e-3, abs=1e-9)
    assert max(float(np.linalg.norm(s.force_n)) for s in out.samples[50:]) < 6.0


def test_the_way_out_after_a_free_way_is_straight_up_and_not_back_over_it() -> None:
    # Between two touches of a panel beside a plug that stands proud of it: back over the first
    # place would lead through the plug.
    world = ElasticWorld(lambda tip: wall(1e6)(tip - [0, 0, 2e-3, 0, 0, 0]))
    motions = contact(world)

    async def out_at_the_second_place() -> ContactMotion:
        await motions.touch(DOWN, 5e-3, 5.0, 10e-3)
        await motions.back_out(-1e-3)
        await motions.move_free(np.array([4e-3, 0.0, 1.5e-3]), np.zeros(3), 10e-3)
        await motions.touch(DOWN, 3e-3, 5.0)
        return await motions.back_out(2e-3)

    out = run(out_at_the_second_place())
    assert {round(1e3 * s.task_position_tip_m[0], 2) for s in out.samples} == {4.0}


def test_the_way_out_after_a_slide_is_not_back_over_the_face() -> None:
    motions = contact(ElasticWorld(wall(1e5)), LoopFigures(1e5, 20e-3))

    async def out_after_the_slide() -> ContactMotion:
        await motions.touch(DOWN, 3e-3, 8.0)
        way = np.array([[2e-3, 0.0]])
        await motions.slide(way, 8.0, 5e-3, lambda _sample: False, 8.0)
        return await motions.back_out(2e-3)

    out = run(out_after_the_slide())
    assert {round(1e3 * s.task_position_tip_m[0], 1) for s in out.samples} == {2.0}


def test_a_turn_of_two_degrees_against_a_spring_converges_at_any_attitude() -> None:
    def felt(tip: np.ndarray) -> np.ndarray:
        """The hole is askew by two degrees and turns the peg into its axis."""
        askew = np.array([np.radians(2.0), 0.0, 0.0])
        turning = -9.0 * (tip[3:] - askew)
        return np.concatenate([[0.0, 0.0, -1e6 * max(tip[2], 0.0)], turning])

    world = ElasticWorld(felt)
    motions = contact(world)
    run(motions.comply(5.0, 6.0))
    assert np.degrees(world.sent[-1][3:]) == pytest.approx([2.0, 0.0, 0.0], abs=0.05)


def test_a_peg_that_gives_way_without_turns_keeps_its_attitude() -> None:
    def felt(tip: np.ndarray) -> np.ndarray:
        """A chamfer pushes aside, beside the tip."""
        aside_n = 1e5 * (0.3e-3 - tip[0])
        return np.array([aside_n, 0.0, -1e6 * max(tip[2], 0.0), 0.0, 0.003 * aside_n, 0.0])

    world = ElasticWorld(felt)
    motions = contact(world)
    run(motions.comply(5.0, 3.0, turns=False))
    assert world.sent[-1][0] == pytest.approx(0.3e-3, abs=0.02e-3)
    assert world.sent[-1][3:] == pytest.approx(np.zeros(3), abs=1e-9)


class AlwaysLate(dict[int, float]):
    """Late ticks without an end: each takes three periods, in which the arm stands."""

    def get(self, key: int, default: float | None = None) -> float:  # type: ignore[override]
        return 3.0


@pytest.mark.parametrize(
    "begin",
    [
        # Ways so short that next to all of the time is what every motion is given.
        lambda motions: motions.back_out(-9.15e-3),
        pytest.param(lambda motions: motions.feed(9.25e-3, 30.0), marks=pytest.mark.figures),
    ],
    ids=["back out", "feed"],
)
def test_a_motion_that_late_ticks_have_kept_from_its_way_is_no_end_of_it(
    begin: Callable[[StreamedContact], Coroutine[Any, Any, ContactMotion]],
) -> None:
    """Told as an end by time it would be taken for a peg that is out, or for a seat not met."""
    tip = np.array([0.0, 0.0, 9.2e-3, 0.0, 0.0, 0.0])
    world = ElasticWorld(lambda _tip: np.zeros(6), tip=tip, late_ticks=AlwaysLate())
    with pytest.raises(StreamLate, match=r"given up after .* of its way left, .* 9\.2 mm"):
        run(begin(contact(world)))


def test_late_ticks_never_make_a_longer_step() -> None:
    late = {20: 2.0, 30: 4.0, 31: 1.0, 60: 2.5, 90: 6.0}
    world = ElasticWorld(wall(1e6), late_ticks=late)
    ticks = Ticks()
    motions = contact(world, ticks=ticks)
    run(motions.move_free(np.array([5e-3, 0.0, -1e-3]), UPRIGHT, 10e-3))
    steps = np.linalg.norm(np.diff([tip[:3] for tip in world.sent], axis=0), axis=1)
    assert steps.max() <= 10e-3 * world.period_s * 1.0001
    assert [str(t.pace) for t in ticks.all].count("hold") == 2
    assert steps[19] == 0.0  # the tick after the late one sends the same target again


def test_a_tick_tells_the_speed_that_was_commanded() -> None:
    ticks = Ticks()
    world = ElasticWorld(lambda _tip: np.zeros(6))
    # Slower than every bound of a touch, and far enough to come to it.
    run(contact(world, ticks=ticks).touch(DOWN, 0.05e-3, 8.0, 0.05e-3))
    speeds = [tick.speed_m_s for tick in ticks.all]
    assert max(speeds) == pytest.approx(0.05e-3)
    assert speeds[-1] == pytest.approx(0.0, abs=1e-9)


def test_a_tick_that_stays_away_ends_the_stream() -> None:
    world = ElasticWorld(wall(1e6), late_ticks={40: 13.0})
    with pytest.raises(StreamLate, match="52 ms between two ticks"):
        run(contact(world).touch(DOWN, 1e-3, 8.0))


def test_a_silent_sensor_stops_the_motion_and_then_ends_it() -> None:
    world = ElasticWorld(wall(1e6))
    world.silent_from_s = world.now_s + 0.05
    ticks = Ticks()
    with pytest.raises(StreamLate, match=r"the newest force is 2[0-9] ms old"):
        run(contact(world, ticks=ticks).move_free(np.array([5e-3, 0, -1e-3]), UPRIGHT, 5e-3))
    assert [str(tick.pace) for tick in ticks.all][-2:] == ["brake", "brake"]


def test_a_trip_of_the_guard_is_the_fault_of_the_motion() -> None:
    world = ElasticWorld(wall(1e6), trip_above_n=20.0)
    with pytest.raises(ForceLimitExceeded, match="force above its limit"):
        run(contact(world).touch(DOWN, 3e-3, 60.0, 1e-3))


@pytest.mark.parametrize(("stiffness_n_m", "watched_n"), [(1e5, 20.0), (1e6, 50.0), (1e6, 20.0)])
def test_what_stands_in_a_free_way_is_met_with_less_than_the_guard_allows(
    stiffness_n_m: float, watched_n: float
) -> None:
    above_m = np.array([0.0, 0.0, -2e-3, 0.0, 0.0, 0.0])
    world = ElasticWorld(wall(stiffness_n_m), sigma_n=0.1, tip=above_m)
    motions = contact(world, LoopFigures(stiffness_n_m, world.dead_time_s))
    motions.watched_n = watched_n

    async def go_and_stand() -> ContactMotion:
        moved = await motions.move_free(np.array([0.0, 0.0, 2e-3]), UPRIGHT, 20e-3)
        await motions.touch(DOWN, 0.0, 100.0)
        return moved

    moved = run(go_and_stand())
    assert moved.ended is Ended.FORCE
    greatest_n = -min(force[2] for force in world.forces)
    # Above what counts as a contact, since only then the arm knows of it.
    assert 8.0 < greatest_n < watched_n


@pytest.mark.parametrize(("depth_mm", "sinks_mm"), [(-1.0, 0.0), (-1.0, 0.5), (0.5, 0.0)])
def test_a_way_over_the_face_is_slow_as_far_as_it_sinks_and_one_beside_it_all_along(
    depth_mm: float, sinks_mm: float
) -> None:
    def took_s(watched_n: float) -> float:
        tip = np.array([0.0, 0.0, depth_mm * 1e-3, 0.0, 0.0, 0.0])
        world = ElasticWorld(lambda _tip: np.zeros(6), tip=tip)
        motions = contact(world, LoopFigures(1e6, world.dead_time_s))
        motions.watched_n = watched_n
        begun_s = world.now_s
        run(motions.move_free(np.array([1e-3, 0.0, 1e-3 * (depth_mm + sinks_mm)]), UPRIGHT, 1.0))
        return world.now_s - begun_s

    # The limit of the settings is 50 N.
    assert (took_s(20.0) > 1.2 * took_s(50.0)) is (depth_mm > 0 or sinks_mm > 0)


def test_a_push_sideways_goes_on_to_press() -> None:
    hole = Hole(1e6, clearance_m=0.1e-3, depth_m=2e-3)
    world = ElasticWorld(hole, sigma_n=0.1, tip=np.array([0, 0, 1.95e-3, 0, 0, 0.0]))
    motions = contact(world)

    async def push() -> ContactMotion:
        await motions.press(5.0, 2.0)
        return await motions.touch(np.array([1.0, 0.0, 0.0]), 0.5e-3, 3.0)

    pushed = run(push())
    assert pushed.ended is Ended.FORCE
    assert pushed.last.task_position_tip_m[0] == pytest.approx(0.103e-3, abs=0.003e-3)
    assert pushed.last.force_n[2] == pytest.approx(-5.0, abs=1.0)
