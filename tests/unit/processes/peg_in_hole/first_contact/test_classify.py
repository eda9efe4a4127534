import asyncio

import numpy as np
import pytest

from cellctl.processes.peg_in_hole.first_contact.classify import (
    ContactClass,
    class_by_force,
    class_by_touches,
    classify_contact,
    light_threshold_n,
)
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
