"""How far arm and contact yield, told by the push."""

import numpy as np
import pytest

from cellctl.cell.contact_motion.motion_rules.ends import SOFTEST
from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.verdict.yielding import yielded_m

STATED_N_M = 1e5
PUSH_N = 6.0


def _push(
    stiffness_n_m: float, *, axis: int = 0, sign: float = 1.0, step_m: float = 4e-6
) -> tuple[ContactSample, ...]:
    """In the free, then against a wall that yields; noise as a cell has it."""
    rng = np.random.default_rng(2)
    ways_m = np.arange(-0.1e-3, PUSH_N / stiffness_n_m + step_m, step_m)
    samples = []
    for number, way_m in enumerate(ways_m):
        position_m, force_n = np.zeros(3), rng.normal(0.0, 0.05, 3)
        position_m[axis] = sign * way_m
        force_n[axis] -= sign * stiffness_n_m * max(way_m, 0.0)
        samples.append(
            ContactSample(8e-3 * number, position_m, np.zeros(3), force_n, np.zeros(3), 0.05)
        )
    return tuple(samples)


@pytest.mark.parametrize("softer", [1.0, 1.4, 1.8])
@pytest.mark.parametrize(("axis", "sign"), [(0, 1.0), (0, -1.0), (1, -1.0)])
def test_a_push_tells_how_soft_the_arm_is_sideways(softer: float, axis: int, sign: float) -> None:
    samples = _push(STATED_N_M / softer, axis=axis, sign=sign)
    told_m = yielded_m(samples, axis, sign, PUSH_N, STATED_N_M)
    assert told_m == pytest.approx(softer * PUSH_N / STATED_N_M, rel=0.06)


def test_an_arm_is_never_taken_for_stiffer_than_stated() -> None:
    samples = _push(4 * STATED_N_M, step_m=1e-6)
    assert yielded_m(samples, 0, 1.0, PUSH_N, STATED_N_M) == pytest.approx(PUSH_N / STATED_N_M)


def test_what_is_far_softer_shows_as_play() -> None:
    samples = _push(STATED_N_M / 10)
    told_m = yielded_m(samples, 0, 1.0, PUSH_N, STATED_N_M)
    assert told_m == pytest.approx(SOFTEST * PUSH_N / STATED_N_M)


def test_a_push_with_few_samples_says_nothing_of_its_own() -> None:
    samples = _push(STATED_N_M / 2)[-3:]
    assert yielded_m(samples, 0, 1.0, PUSH_N, STATED_N_M) == pytest.approx(PUSH_N / STATED_N_M)
