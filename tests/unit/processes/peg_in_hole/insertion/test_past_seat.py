"""Feeds that a seat, friction, contacts or a dead sensor make feel what they feel."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.insertion.past_seat import PastSeat
from cellctl.processes.peg_in_hole.plan.task import PartContacts, SearchTask
from tests.unit.processes.peg_in_hole.tasks import pin

_STEP_MM = 0.005
_SIGMA_N = 0.1
_STIFFNESS_N_MM = 100.0


def _task(contacts: PartContacts | None = None) -> SearchTask:
    task = pin(stiffness_n_m=_STIFFNESS_N_MM * 1e3, force_sigma_n=_SIGMA_N)
    return replace(task, fit=replace(task.fit, contacts=contacts))


def _ends_mm(task: SearchTask, felt_n: Callable[[float], float], side_n: float = 0.0) -> float:
    """How far past the drawn seat the arm goes that feels such a force at such a distance."""
    watch, rng = PastSeat(task, 0.0), np.random.default_rng(3)
    seat_mm = task.fit.depth_m * 1e3
    for past_mm in np.arange(-2.0, 1.0, _STEP_MM).tolist():
        tip = np.array([0.0, 0.0, (seat_mm + past_mm) * 1e-3])
        force = rng.normal(0.0, _SIGMA_N, 3) - np.array([side_n, 0.0, felt_n(past_mm)])
        if watch.take(ContactSample(0.0, tip, np.zeros(3), force, np.zeros(3), _SIGMA_N)):
            return float(past_mm)
    return 1.0


def _seat(at_mm: float, friction_n: float = 0.0, slope: float = 1.0) -> Callable[[float], float]:
    return lambda past_mm: friction_n + slope * _STIFFNESS_N_MM * max(0.0, past_mm - at_mm)


def _dies(at_n: float) -> Callable[[float], float]:
    return lambda past_mm: min(at_n, _seat(0.0)(past_mm))


@pytest.mark.parametrize(
    ("at_mm", "slope"),
    [(-0.25, 1.0), (0.0, 1.0), (0.25, 1.0), (-0.25, 0.5), (0.0, 0.5), (0.1, 0.5)],
)
def test_a_force_that_rises_is_that_of_the_seat(at_mm: float, slope: float) -> None:
    """Also that of a seat that yields as much as the arm."""
    force_n = _seat(at_mm, 1.0, slope)
    assert force_n(_ends_mm(_task(), force_n)) > 18.0


@pytest.mark.parametrize("dies_n", [0.0, 1.0, 5.0, 12.0, 18.0])
def test_a_sensor_that_dies_in_the_rise_ends_the_feed(dies_n: float) -> None:
    """What the arm truly presses with stays about what a seat 0.3 mm deeper would have let it."""
    ends_mm = _ends_mm(_task(), _dies(dies_n))
    assert ends_mm * _STIFFNESS_N_MM < max(32.0, dies_n + 13.0)


def test_nothing_felt_ends_it_at_the_tolerance_of_the_seat() -> None:
    assert _ends_mm(_task(), lambda _past_mm: 0.0) == pytest.approx(0.3, abs=0.02)


def test_contacts_of_the_part_explain_a_force_that_stays() -> None:
    """By which the arm yields, so that the tip of a good part is so much farther on."""
    contacts = PartContacts(6e-3, 6.5e-3, 25.0, 40.0)
    force_n = _seat(0.2 + 0.3, friction_n=30.0)  # the seat 0.2 mm deeper, the arm behind by 0.3 mm
    assert force_n(_ends_mm(_task(contacts), force_n)) > 50.0
    assert _ends_mm(_task(contacts), lambda _past_mm: 30.0) == pytest.approx(0.6, abs=0.02)


def test_a_part_that_slips_is_not_pushed_on() -> None:
    assert _ends_mm(_task(), lambda _past_mm: 9.0) < 0.0
