"""A push on which nothing is felt, and the press that tells a dead sensor from a wide hole."""

import asyncio

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import Condition, ContactMotion, ContactSample, Ended
from cellctl.processes.peg_in_hole.verdict.answer import NothingFelt, sensor_answers
from tests.rigs.insertion.traps import PegState, StandingPeg
from tests.unit.processes.peg_in_hole.tasks import pin

_TASK = pin(stiffness_n_m=1e5, force_sigma_n=0.1)
_FREE_MM = 2 * _TASK.fit.clearance_m * 1e3


def _sample(x_mm: float, fx_n: float) -> ContactSample:
    tip, force = np.array([x_mm * 1e-3, 0.0, 0.0]), np.array([fx_n, 0.0, 0.0])
    return ContactSample(0.0, tip, np.zeros(3), force, np.zeros(3), 0.1)


def _ends_mm(wall_mm: float, dies_n: float = np.inf) -> float:
    """Way of a push whose wall stands so far off; the sensor stays at a force once it has felt
    it."""
    felt, rng = NothingFelt(_TASK, 0), np.random.default_rng(1)
    for x_mm in np.arange(0.0, 1.0, 0.004).tolist():
        against_n = min(dies_n, 100.0 * max(0.0, x_mm - wall_mm))
        if felt(_sample(x_mm, -against_n + float(rng.normal(0.0, 0.1)))):
            return float(x_mm)
    return 1.0


def test_walls_as_drawn_are_met_before_a_push_ends() -> None:
    assert _ends_mm(0.0) == 1.0
    assert _ends_mm(_FREE_MM + 0.09) == 1.0


def test_a_push_that_feels_nothing_ends_little_beyond_the_clearance() -> None:
    assert _FREE_MM + 0.1 < _ends_mm(5.0) < _FREE_MM + 0.15


@pytest.mark.parametrize("dies_n", [0.0, 2.0, 4.0])
def test_a_sensor_that_dies_in_a_push_ends_it(dies_n: float) -> None:
    assert _ends_mm(0.0, dies_n) * 100.0 < 25.0 + dies_n


class _Pressed(StandingPeg):
    """Sinks at every press until it ends, and feels it unless the sensor is dead."""

    def __init__(self, state: PegState) -> None:
        super().__init__(_TASK, state, np.random.default_rng(1))
        self.pressed_n: list[float] = []
        self.sunk_in_m: list[float] = []

    async def press(
        self, force_n: float, hold_s: float, until: Condition | None = None
    ) -> ContactMotion:
        self.pressed_n.append(force_n)
        samples = []
        self.sunk_in_m.append(0.0)
        for _ in range(100):
            self.position_m[2] += 2e-6
            self.sunk_in_m[-1] += 2e-6
            samples.append((await super().press(force_n, hold_s / 100, until)).last)
            if until is not None and until(samples[-1]):
                return ContactMotion(Ended.CONDITION, tuple(samples))
        return ContactMotion(Ended.TIME, tuple(samples))


@pytest.mark.parametrize(
    ("state", "answers"), [(PegState.WRONG_HOLE, True), (PegState.FROZEN, False)]
)
def test_a_greater_press_tells_whether_the_sensor_answers(state: PegState, answers: bool) -> None:
    motions = _Pressed(state)
    standing = asyncio.run(StandingPeg.press(motions, 2.0, 0.1)).last
    assert asyncio.run(sensor_answers(motions, _TASK, standing, 2.0)) is answers
    more_n, back_n = motions.pressed_n
    assert more_n > 4.0
    assert back_n == 2.0


def test_a_dead_sensor_lets_a_press_sink_only_by_what_a_soft_arm_would_yield() -> None:
    motions = _Pressed(PegState.FROZEN)
    standing = asyncio.run(StandingPeg.press(motions, 2.0, 0.1)).last
    asyncio.run(sensor_answers(motions, _TASK, standing, 2.0))
    assert motions.sunk_in_m[0] < 0.09e-3


class _Wavering(_Pressed):
    """What ends the press is felt once, and a little less when the arm has come to rest."""

    async def press(
        self, force_n: float, hold_s: float, until: Condition | None = None
    ) -> ContactMotion:
        pressed = await super().press(force_n, hold_s, until)
        after = _sample(0.0, 0.0)
        after.force_n[2] = -2.9
        return ContactMotion(pressed.ended, (*pressed.samples, after))


def test_what_was_felt_once_counts() -> None:
    motions = _Wavering(PegState.WRONG_HOLE)
    standing = asyncio.run(StandingPeg.press(motions, 2.0, 0.1)).last
    assert asyncio.run(sensor_answers(motions, _TASK, standing, 2.0))
