"""Pushes to the sides: how fast they may be."""

import asyncio
from dataclasses import replace

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import Condition, ContactMotion, ContactSample, Ended
from cellctl.geometry.pose import Array
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.verdict.lateral import (
    SIDES,
    capture_of,
    measure_capture,
    push_force_n,
    walls_answer,
)
from tests.rigs.insertion.traps import PegState, StandingPeg
from tests.unit.processes.peg_in_hole.tasks import pin


class _PushSpeeds(StandingPeg):
    """Keeps the speeds of all pushes."""

    def __init__(self, task: SearchTask) -> None:
        super().__init__(task, PegState.INSERTED, np.random.default_rng(1))
        self.speeds_m_s: list[float | None] = []

    async def touch(
        self,
        direction: Array,
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        self.speeds_m_s.append(speed_m_s)
        return await super().touch(direction, travel_m, force_n, speed_m_s, until)


class _Stepping(StandingPeg):
    """A push goes on in steps as long as it is let, and keeps what it was pushed beyond its walls
    by."""

    def __init__(self, state: PegState) -> None:
        super().__init__(pin(stiffness_n_m=1e5, force_sigma_n=0.1), state, np.random.default_rng(1))
        self.ways_m: list[float] = []

    async def touch(
        self,
        direction: Array,
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        self.ways_m.append(0.0)
        while True:
            step = await super().touch(direction, 0.01e-3, force_n, speed_m_s)
            self.ways_m[-1] += 0.01e-3
            if step.ended is Ended.FORCE or self.ways_m[-1] >= travel_m:
                return step
            if until is not None and until(step.last):
                return ContactMotion(Ended.CONDITION, step.samples)


def test_a_dead_sensor_ends_the_first_push_and_all_others() -> None:
    motions = _Stepping(PegState.FROZEN)
    found = asyncio.run(measure_capture(motions, motions.task))
    assert found.resisted == 0
    (way_m,) = motions.ways_m
    assert way_m < 2 * motions.task.fit.clearance_m + 0.15e-3


def test_a_hole_that_is_wider_is_pushed_to_its_walls() -> None:
    motions = _Stepping(PegState.WRONG_HOLE)
    found = asyncio.run(measure_capture(motions, motions.task))
    assert found.resisted == 4
    most_m = 2 * motions.task.fit.clearance_m + 0.1e-3
    assert found.play_x_m is not None
    assert found.play_x_m > most_m


@pytest.mark.parametrize(
    ("state", "answers"),
    [(PegState.INSERTED, True), (PegState.WRONG_HOLE, False), (PegState.FROZEN, False)],
)
def test_walls_answer_a_sensor_that_lives(state: PegState, answers: bool) -> None:
    motions = _Stepping(state)
    assert asyncio.run(walls_answer(motions, motions.task)) is answers
    assert max(motions.ways_m) < 2 * motions.task.fit.clearance_m + 0.2e-3


def _speeds(task: SearchTask) -> list[float]:
    motions = _PushSpeeds(task)
    assert asyncio.run(measure_capture(motions, task)).resisted == 4
    return [speed for speed in motions.speeds_m_s if speed is not None]


def test_a_soft_arm_pushes_as_fast_as_the_study_allows() -> None:
    assert _speeds(pin(stiffness_n_m=1e5)) == [0.5e-3] * 4


@pytest.mark.parametrize("insertion_n", [20.0, 40.0])
def test_a_push_of_a_stiff_arm_stays_below_the_limit(insertion_n: float) -> None:
    """What it grows by until the arm has answered counts."""
    task = pin(stiffness_n_m=2e6, dead_time_s=0.04)
    task = replace(task, limits=replace(task.limits, insertion_n=insertion_n))
    grows_s = task.cell.dead_time_s + 0.03
    for speed_m_s in _speeds(task):
        grows_n = task.cell.stiffness_n_m * speed_m_s * grows_s
        assert push_force_n(task.cell) + grows_n < insertion_n
        assert grows_n > 1.0


@pytest.mark.parametrize(
    ("ends_mm", "play_mm"),
    [
        (0.12, 0.115),
        (0.07, 0.015),  # walls without any play, and an arm of nearly the stated stiffness
        (-0.06, None),
        (-1.2, None),
    ],
)
def test_a_play_that_no_walls_can_have_is_not_measured(
    ends_mm: float, play_mm: float | None
) -> None:
    """Each push is met so far on its own side of the middle."""
    task = pin(stiffness_n_m=1e5)
    pushes = {}
    for axis, sign in SIDES:
        tip, force = np.zeros(3), np.zeros(3)
        tip[axis], force[axis] = sign * ends_mm * 1e-3, -sign * push_force_n(task.cell)
        sample = ContactSample(0.0, tip, np.zeros(3), force, np.zeros(3), 0.0)
        pushes[axis, sign] = ContactMotion(Ended.FORCE, (sample,))
    begun = ContactSample(0.0, np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), 0.0)
    found = capture_of(begun, pushes, task)
    for play_m in (found.play_x_m, found.play_y_m):
        if play_mm is None:
            assert play_m is None
        else:
            assert play_m == pytest.approx(play_mm * 1e-3, abs=0.02e-3)
