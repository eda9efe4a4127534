import asyncio

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import Condition, ContactMotion
from cellctl.geometry.pose import Array
from cellctl.processes.peg_in_hole.first_contact.classify import (
    ContactClass,
    class_by_force,
    class_by_touches,
    classify_contact,
    light_threshold_n,
)
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth
from tests.rigs.insertion.traps import PegState, StandingPeg
from tests.unit.processes.peg_in_hole.tasks import pin

Four = tuple[bool, bool, bool, bool]


@pytest.mark.parametrize(
    ("force_n", "expected"),
    [
        ((0.0, 0.0, -10.0), ContactClass.END_FACE),
        ((2.0, 0.0, -10.0), ContactClass.END_FACE),  # friction alone
        ((0.0, 6.0, -6.0), ContactClass.EDGE),
        ((8.0, 0.0, -1.0), ContactClass.SIDE),
    ],
)
def test_class_by_force(force_n: tuple[float, ...], expected: ContactClass) -> None:
    assert class_by_force(np.array(force_n), pin().cell) is expected


@pytest.mark.parametrize(
    ("resisted", "depth_mm", "expected"),
    [
        ((True, True, True, True), 1.0, ContactClass.ALIGNED),
        ((True, True, True, True), 0.1, ContactClass.STUCK),
        ((False, False, False, False), 0.0, ContactClass.END_FACE),
        ((True, True, False, False), 1.0, ContactClass.WRONG_FEATURE),
        ((False, False, True, True), 1.0, ContactClass.WRONG_FEATURE),
        ((True, False, False, False), 0.0, ContactClass.SIDE),
    ],
)
def test_class_by_touches(resisted: Four, depth_mm: float, expected: ContactClass) -> None:
    found = class_by_touches(resisted, depth_mm * 1e-3, 0.3e-3, ContactClass.END_FACE)
    assert found is expected


def test_friction_alone_is_below_the_threshold() -> None:
    cell = pin(friction=0.3).cell
    assert light_threshold_n(cell, 2.5) > 0.3 * 2.5 + 3 * cell.force_sigma_n - 1e-9


def test_a_peg_on_the_face_is_on_the_face() -> None:
    far = Truth(np.array([50e-3, 0.0]), np.zeros(2))
    motions = KinematicMotions(pin(), far, np.random.default_rng(1))
    assert asyncio.run(classify_contact(motions, pin(), 1e-3)).found is ContactClass.END_FACE


def test_a_peg_between_its_walls_is_aligned() -> None:
    motions = StandingPeg(pin(), PegState.INSERTED, np.random.default_rng(1))
    assert asyncio.run(classify_contact(motions, pin(), 1e-3)).found is ContactClass.ALIGNED


class _SlideSpeeds(StandingPeg):
    """Keeps the speeds of all slides."""

    def __init__(self, task: SearchTask) -> None:
        super().__init__(task, PegState.INSERTED, np.random.default_rng(1))
        self.speeds_m_s: list[float] = []

    async def slide(
        self,
        way_m: Array,
        press_n: float,
        speed_m_s: float,
        until: Condition,
        side_force_n: float,
    ) -> ContactMotion:
        self.speeds_m_s.append(speed_m_s)
        return await super().slide(way_m, press_n, speed_m_s, until, side_force_n)


@pytest.mark.parametrize("touch_m_s", [0.05e-3, 0.4e-3])
def test_a_stiff_arm_returns_no_faster_than_it_touches(touch_m_s: float) -> None:
    """What stands in the way back is a wall, as in a touch."""
    motions = _SlideSpeeds(pin())
    asyncio.run(classify_contact(motions, pin(), touch_m_s))
    assert motions.speeds_m_s == [touch_m_s] * 4
