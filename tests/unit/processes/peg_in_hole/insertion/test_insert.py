import asyncio
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import Condition, ContactMotion, ContactSample, Ended
from cellctl.processes.peg_in_hole.faults import (
    HoleBlocked,
    NotSeated,
    PegJammed,
    PegNotInserted,
    PegSlipped,
    PegWedged,
    SensorDead,
)
from cellctl.processes.peg_in_hole.insertion.felt import Standing, seat_slope_n_m
from cellctl.processes.peg_in_hole.insertion.insert import Fed, insert
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth
from tests.unit.processes.peg_in_hole.tasks import pin

Array = NDArray[np.float64]
LIMIT_N = 30.0


class Bore(KinematicMotions):
    """A hole in which the peg stands at given depths, one after another, before it goes on."""

    def __init__(self, stands_mm: list[float], *, side_n: float, wedged: bool = False) -> None:
        task = pin(force_sigma_n=1e-3)
        truth = Truth(np.zeros(2), np.zeros(2))
        super().__init__(task, truth, np.random.default_rng(0))
        self.stands_mm, self.side_n, self.wedged = stands_mm, side_n, wedged
        self.greatest_asked_n = 0.0
        self.must_stay = False

    async def feed(
        self,
        depth_m: float,
        force_limit_n: float,
        until: Condition | None = None,
        past_m: float = 0.0,
    ) -> ContactMotion:
        self.greatest_asked_n = max(self.greatest_asked_n, force_limit_n)
        if not self.stands_mm:
            return await super().feed(depth_m, force_limit_n, until, past_m)
        self.position_m[2] = self.stands_mm.pop(0) * 1e-3
        return ContactMotion(Ended.FORCE, (self.felt(force_limit_n),))

    async def press(
        self, force_n: float, hold_s: float, until: Condition | None = None
    ) -> ContactMotion:
        self.must_stay |= until is None
        self.time_s += hold_s
        return ContactMotion(Ended.TIME, (self.felt(force_n),))

    async def comply(
        self,
        press_n: float,
        hold_s: float,
        until: Condition | None = None,
        *,
        turns: bool = True,
    ) -> ContactMotion:
        # As the streamed contact: it may not be lost where nothing waits for that.
        self.must_stay |= press_n > 0 and until is None
        return await super().comply(press_n, hold_s, until, turns=turns)

    def felt(self, press_n: float) -> ContactSample:
        side = self.side_n * (1.0 if self.wedged else press_n / LIMIT_N)
        force = np.array([side, 0.0, -press_n])
        moment = np.array([0.0, side * 0.05, 0.0])
        return ContactSample(self.time_s, self.position_m.copy(), np.zeros(3), force, moment, 0.3)


def fed(bore: Bore, face_yields_m: float = 0.0) -> Fed:
    result = asyncio.run(insert(bore, bore.task, face_yields_m))
    assert bore.greatest_asked_n == bore.task.limits.insertion_n  # no retry asks for more
    return result


def test_a_free_hole_is_fed_to_its_seat() -> None:
    found = fed(Bore([], side_n=0))
    assert found.depth_m == pytest.approx(12e-3, abs=1e-6)
    assert found.seat_force_n == pytest.approx(LIMIT_N, abs=0.1)
    assert found.seat_slope_n_m == pytest.approx(1e6, rel=0.01)
    assert found.recoveries == ()


def test_depth_counts_from_the_face_and_not_from_where_it_had_yielded_to() -> None:
    # At its seat, and by the frame 0.4 mm short of it: the touches had pressed the face in.
    found = fed(Bore([11.6], side_n=0), face_yields_m=0.4e-3)
    assert found.recoveries == ()
    assert found.depth_m == pytest.approx(12e-3 - LIMIT_N / 1e6, abs=1e-6)


def test_a_jam_is_freed_by_giving_way_first() -> None:
    found = fed(Bore([4.0], side_n=10))
    assert found.recoveries == ("give way",)
    assert found.greatest_force_n == pytest.approx(LIMIT_N, abs=0.1)


@pytest.mark.parametrize("side_n", [10.0, 0.0])
def test_a_peg_that_comes_free_may_lose_its_contact(side_n: float) -> None:
    bore = Bore([4.0], side_n=side_n)
    assert fed(bore).recoveries
    assert not bore.must_stay


def test_recoveries_come_in_order_and_end_after_three() -> None:
    with pytest.raises(PegJammed, match="tried: give way, wiggle, yaw"):
        fed(Bore([4.0, 4.5, 5.0, 5.5, 6.0], side_n=10))


def test_a_straight_peg_at_the_same_depth_twice_is_blocked() -> None:
    with pytest.raises(HoleBlocked, match=r"depth 5\.05 mm"):
        fed(Bore([5.0, 5.05], side_n=0))


class _Bottomless(Bore):
    """A feed that no force stops: a hole too deep, or a sensor that feels nothing."""

    async def feed(
        self,
        depth_m: float,
        force_limit_n: float,
        until: Condition | None = None,
        past_m: float = 0.0,
    ) -> ContactMotion:
        self.position_m[2] = depth_m + past_m
        return ContactMotion(Ended.TRAVEL, (self.felt(0.5),))


class _Unfelt(Bore):
    """Goes on in small steps as long as it is let, and feels the same all the way."""

    felt_n = 0.5

    async def feed(
        self,
        depth_m: float,
        force_limit_n: float,
        until: Condition | None = None,
        past_m: float = 0.0,
    ) -> ContactMotion:
        assert until is not None
        samples = []
        while self.position_m[2] < depth_m + past_m:
            self.position_m[2] += 0.01e-3
            samples.append(self.felt(self.felt_n))
            if until(samples[-1]):
                return ContactMotion(Ended.CONDITION, tuple(samples))
        return ContactMotion(Ended.TRAVEL, tuple(samples))


def test_a_feed_that_feels_nothing_ends_no_farther_past_the_seat_than_it_may_lie() -> None:
    # 1e6 N/m: with a sensor that is dead, 0.03 mm more are as many newtons.
    bore = _Unfelt([], side_n=0)
    with pytest.raises(NotSeated, match="nothing has stopped the feed at the seat"):
        fed(bore)
    assert float(bore.position_m[2]) <= 12.33e-3


def test_a_force_that_does_not_rise_at_the_seat_is_that_of_a_part_that_slips() -> None:
    bore = _Unfelt([], side_n=0)
    bore.felt_n = 9.0
    with pytest.raises(PegSlipped, match=r"the force does not rise at the seat: .* axial 9\.0 N"):
        fed(bore)
    assert float(bore.position_m[2]) < 12e-3


def test_a_feed_that_nothing_stops_has_found_no_seat() -> None:
    bore = _Bottomless([], side_n=0)
    with pytest.raises(NotSeated, match=r"nothing has stopped the feed: depth 12\.33 mm"):
        asyncio.run(insert(bore, bore.task, 0.0))


class _Dead(_Unfelt):
    """Nothing is felt of a push to a side either."""

    async def touch(
        self,
        direction: Array,
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        return ContactMotion(Ended.CONDITION, (self.felt(self.felt_n),))


@pytest.mark.parametrize(
    ("insertion_n", "fault", "deepest_mm"), [(29.0, SensorDead, 11.51), (31.0, NotSeated, 12.33)]
)
def test_on_a_stiff_arm_a_dead_sensor_is_found_before_the_seat(
    insertion_n: float, fault: type[PegNotInserted], deepest_mm: float
) -> None:
    """The 0.3 mm by which a seat may lie deeper are 30 N at 1e5 N/m."""
    bore = _Dead([], side_n=0)
    cell = replace(bore.task.cell, stiffness_n_m=1e5)
    task = replace(bore.task, cell=cell, limits=replace(bore.task.limits, insertion_n=insertion_n))
    with pytest.raises(fault):
        asyncio.run(insert(bore, task, 0.0))
    assert float(bore.position_m[2]) * 1e3 <= deepest_mm + 1e-9


def test_a_sensor_is_asked_once_and_both_feeds_are_one_insertion() -> None:
    bore = Bore([4.0], side_n=10)
    found = fed(bore)
    assert bore.touches == 2  # to and fro
    depths_mm = [sample.task_position_tip_m[2] * 1e3 for sample in found.samples]
    assert any(11.4 < depth_mm < 11.6 for depth_mm in depths_mm)
    assert depths_mm[-1] > 12.0


def test_a_chip_that_gives_way_is_passed() -> None:
    assert fed(Bore([5.0], side_n=0)).recoveries == ("back and again",)


def test_side_force_that_stays_is_a_wedge() -> None:
    with pytest.raises(PegWedged, match=r"side 10\.0 N"):
        fed(Bore([4.0], side_n=10, wedged=True))


def test_standing_counts_the_axial_force_against_the_feed() -> None:
    standing = Standing.of(Bore([], side_n=10).felt(20.0))
    assert standing.axial_n == 20
    assert standing.sideways


def test_no_slope_without_two_depths() -> None:
    assert seat_slope_n_m([Bore([], side_n=0).felt(1.0)]) is None
