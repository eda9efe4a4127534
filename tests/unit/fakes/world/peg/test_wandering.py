"""Pegs pushed about at random: forces balance, and no part of a peg is ever inside the plate."""

import math

import numpy as np
import pytest

from fakes.world.frames import Array
from fakes.world.peg.fit import Fit
from fakes.world.peg.held_peg import HeldPeg
from tests.rigs.sweeps import sweep
from tests.unit.fakes.world.peg.pushing import MM, arm, pin, plug, reach_into_plate_m

_STEPS = 500
_HARDEST_N = 40.0
_DRAG = np.array([10.0] * 3 + [1e-3] * 3) / 1e-3


def _wandered(peg: HeldPeg, robot_n_m: Array, seed: int) -> tuple[float, float]:
    """Largest unbalanced force (N) of all steps, and how deep the peg was in the plate (m)."""
    rng = np.random.default_rng(seed)
    unbalanced_n = deepest_m = 0.0
    for number in range(_STEPS):
        if number % 100 == 0:
            way = rng.normal([0.0, 0.0, -3e-6], [3e-6, 3e-6, 3e-6])
            turn = rng.normal(0.0, 3e-5, 2)
        before, failures = np.array(peg.pose), peg.failures
        commanded = np.array(peg.commanded)
        pressed = np.linalg.norm(peg.wrench[:3]) > _HARDEST_N
        commanded[:3] += [0.0, 0.0, 3e-6] if pressed else way
        commanded[3:5] += turn
        x, y, z, tilt_x, tilt_y, yaw = commanded.tolist()
        peg.follow((x, y, z, tilt_x, tilt_y, yaw), 1e-3)
        if peg.touching and peg.failures == failures:
            drag = _DRAG * (np.array(peg.pose) - before)
            left = robot_n_m @ (np.array(peg.commanded) - peg.pose) + peg.wrench - drag
            unbalanced_n = max(unbalanced_n, float(np.abs(left[:3]).max()))
        if number % 20 == 0:
            deepest_m = max(deepest_m, reach_into_plate_m(peg.fit, peg.pose))
    return unbalanced_n, deepest_m


@pytest.mark.parametrize("seed", sweep((1, 2, 3), (1,)))
@pytest.mark.parametrize(
    ("fit", "tilt_deg"), [(pin(0.02, 0.0), 8.0), (pin(0.05), 8.0), (plug(), 2.0)]
)
def test_forces_balance_and_the_peg_stays_out_of_the_plate(
    fit: Fit, tilt_deg: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    tilt = np.deg2rad(rng.uniform(-tilt_deg, tilt_deg, 2))
    x, y = rng.uniform(-0.5 * MM, 0.5 * MM, 2)
    lowest = fit.peg_radius_m * math.sin(math.hypot(*tilt))
    held = arm(1e5, 1e5, 50.0)
    start = (float(x), float(y), lowest, float(tilt[0]), float(tilt[1]), 0.0)
    peg = HeldPeg(fit, held, start)
    unbalanced_n, deepest_m = _wandered(peg, held, seed)
    assert 0.0 < unbalanced_n < 0.1  # zero: nothing was touched
    assert deepest_m < 0.01 * MM
    assert peg.failures <= 0.02 * _STEPS
