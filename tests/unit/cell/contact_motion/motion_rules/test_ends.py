"""What ends a motion in the free: something that is met, and not the contact that it leaves."""

import numpy as np

from cellctl.cell.contact_motion.motion_rules.ends import SomethingMet
from cellctl.cell.contact_motion.motions import ContactSample, Ended

_LIMIT_N, _STIFFNESS_N_M = 7.0, 1e5


def _sample(way_mm: float, force_n: float) -> ContactSample:
    tip, force = np.array([way_mm * 1e-3, 0.0, 0.0]), np.array([force_n, 0.0, 0.0])
    return ContactSample(0.0, tip, np.zeros(3), force, np.zeros(3), 0.1)


def _ended(*samples: tuple[float, float]) -> list[Ended | None]:
    met = SomethingMet(_LIMIT_N, _STIFFNESS_N_M)
    return [met(_sample(*one)) for one in samples]


def test_a_contact_on_the_way_ends_a_motion() -> None:
    assert _ended((0.0, 0.1), (1.0, 6.9), (2.0, 7.1)) == [None, None, Ended.FORCE]


def test_a_motion_may_leave_the_contact_in_which_it_begins() -> None:
    assert _ended((0.0, 8.0), (0.02, 8.2), (0.1, 7.5), (0.2, 0.1)) == [None] * 4


def test_a_contact_that_stays_ends_a_motion_after_what_it_made_the_arm_yield() -> None:
    # 8 N at 1e5 N/m, half as stiff across: 0.16 mm, and 0.1 mm of the arm itself.
    assert _ended((0.0, 8.0), (0.25, 8.0), (0.27, 8.0)) == [None, None, Ended.FORCE]


def test_a_contact_that_grows_ends_a_motion_at_once() -> None:
    assert _ended((0.0, 8.0), (0.01, 9.1)) == [None, Ended.FORCE]


def test_a_contact_that_was_left_is_met_anew() -> None:
    assert _ended((0.0, 8.0), (0.1, 1.0), (0.15, 8.0)) == [None, None, Ended.FORCE]
