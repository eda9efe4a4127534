"""R9 of the study of insertion by touch."""

import asyncio
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.contact_motion.commissioning import commission_contact
from cellctl.errors.streamed_contact import LoopFitRefused
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.interfaces.streaming_robot import StreamReport
from tests.unit.cell.contact_motion.elastic_world import (
    ElasticWorld,
    WorldStream,
    contact_loop,
    wall,
)

START = np.array([0.0, 0.0, -0.06e-3, 0.0, 0.0, 0.0])
FREE_M = 0.05e-3
QUICK, FAST, MIDDLE, SLOW = (2e-3, 3, 0.5e-3), (2e-3, 0, 0.5e-3), (4e-3, 3, 4e-3), (8e-3, 3, 12e-3)
"""Period, ticks of delay and lag: dead times of 11.5, 5.5, 24 and 50 ms."""


@pytest.mark.parametrize(
    ("stiffness_n_m", "arm"),
    [
        (1e5, QUICK),
        pytest.param(1e6, MIDDLE, marks=pytest.mark.figures),
        *(
            pytest.param(stiffness_n_m, arm, marks=pytest.mark.long)
            for stiffness_n_m, arm in ((1e5, FAST), (1e7, FAST), (1e5, SLOW), (1e7, SLOW))
        ),
    ],
)
def test_it_finds_what_arm_and_fixture_truly_have(
    stiffness_n_m: float, arm: tuple[float, int, float]
) -> None:
    period_s, delay_ticks, lag_s = arm
    world = ElasticWorld(
        wall(stiffness_n_m), period_s, delay_ticks, lag_s, sigma_n=0.3, tip=START.copy()
    )
    bounds = LoopFigures(1.5 * stiffness_n_m, 1.5 * world.dead_time_s)
    found = asyncio.run(commission_contact(contact_loop(world, bounds), 3e-3, FREE_M))
    assert found.figures.stiffness_n_m == pytest.approx(stiffness_n_m, rel=0.1)
    assert found.figures.dead_time_s == pytest.approx(world.dead_time_s, rel=0.1)
    assert found.motion_dead_time_s == pytest.approx(
        period_s * delay_ticks + lag_s, rel=0.1, abs=0.3 * period_s
    )
    assert max(-force[2] for force in world.forces) < 45.0


class AskingStream(WorldStream):
    """Asks for the pose before each setpoint, over a link of a busy PC: the answers take long at
    times, and setpoints wait for them."""

    ANSWERS_S = (1e-3, 1e-3, 20e-3)

    def __init__(self, world: ElasticWorld) -> None:
        super().__init__(world)
        self._rng = np.random.default_rng(8)
        self._asked = super().report

    @property
    def report(self) -> StreamReport:
        return replace(self._asked, sent_s=self._sent_s)

    async def advance(self, base_T_flange: RigidTransform) -> StreamReport:
        self._asked = super().report
        self._world.advance(float(self._rng.choice(self.ANSWERS_S)), self._world.sent[-1])
        return await super().advance(base_T_flange)


@pytest.mark.figures
def test_answers_of_a_busy_link_do_not_blur_the_dead_time() -> None:
    world = ElasticWorld(wall(1e5), 8e-3, 0, 5e-3, sigma_n=0.3, tip=START.copy())
    world.sent.append(START.copy())
    world.stream = AskingStream(world)
    waits_s = float(np.mean(AskingStream.ANSWERS_S))
    bounds = LoopFigures(1.5e5, 60e-3)
    found = asyncio.run(commission_contact(contact_loop(world, bounds), 3e-3, FREE_M))
    # A force has waited for the answer, too, before the setpoint that follows from it goes out.
    assert found.figures.dead_time_s == pytest.approx(world.dead_time_s + waits_s, rel=0.15)


def test_a_fixture_that_is_not_there_is_told() -> None:
    world = ElasticWorld(lambda _tip: np.zeros(6), sigma_n=0.3, tip=START.copy())
    with pytest.raises(LoopFitRefused, match=r"no 5 N within 0\.50 mm"):
        asyncio.run(commission_contact(contact_loop(world), 0.5e-3, FREE_M))


def test_a_loop_that_behaves_otherwise_is_refused() -> None:
    world = ElasticWorld(wall(1e6), sigma_n=0.3, tip=START.copy())
    pressed_s: list[float] = []
    """When it was pressed harder than the steps of the loop press."""

    def comes_loose(tip: np.ndarray) -> np.ndarray:
        loose = len(pressed_s) > 0 and world.now_s - pressed_s[-1] > 2.5
        felt = np.asarray(wall(4e5 if loose else 1e6)(tip))
        if felt[2] < -12.0 and not loose:
            pressed_s.append(world.now_s)
        return felt

    world.part = comes_loose
    with pytest.raises(LoopFitRefused, match=r"k theta|off what was felt|overshoots|settles"):
        asyncio.run(commission_contact(contact_loop(world), 3e-3, FREE_M))
