"""A tilted pin without a chamfer finds equilibrium, slid across a tight hole or lowered into it."""

import math

import numpy as np
import pytest

from fakes.world.peg.held_peg import HeldPeg
from tests.rigs.sweeps import sweep
from tests.unit.fakes.world.peg.pushing import MM, arm, pin

_TILT_RAD = math.radians(8.0)
_LOWEST_M = 3.0 * MM * math.sin(_TILT_RAD)
_STEP_M = 5e-6
_HARDEST_N = 60.0


def _held(stiffness: float, x_m: float, y_m: float) -> HeldPeg:
    held = arm(stiffness, stiffness, 50.0)
    start = (x_m, y_m, _LOWEST_M + _STEP_M, 0.0, _TILT_RAD, 0.0)
    return HeldPeg(pin(0.02, 0.0), held, start)


def _slid(stiffness: float, bearing: float, beside_m: float) -> HeldPeg:
    """Across the hole, pressed with 10 N where the face is."""
    along, across = (math.cos(bearing), math.sin(bearing)), (-math.sin(bearing), math.cos(bearing))
    at = np.outer(np.arange(-0.6 * MM, 0.6 * MM, _STEP_M), along) + beside_m * np.array(across)
    peg = _held(stiffness, *at[0].tolist())
    for x_m, y_m in at.tolist():
        pressed_m = _LOWEST_M - 10.0 / stiffness
        peg.follow((x_m, y_m, pressed_m, 0.0, _TILT_RAD, 0.0), 1e-3)
    return peg


def _lowered(stiffness: float, x_m: float, y_m: float) -> HeldPeg:
    """Straight down, until it stands."""
    peg = _held(stiffness, x_m, y_m)
    for height_m in np.arange(_LOWEST_M, -0.5 * MM, -_STEP_M).tolist():
        peg.follow((x_m, y_m, height_m, 0.0, _TILT_RAD, 0.0), 1e-3)
        if np.linalg.norm(peg.wrench[:3]) > _HARDEST_N:
            break
    return peg


@pytest.mark.parametrize("stiffness", sweep((1e5, 1e6), (1e6,)))
def test_nearly_all_steps_find_equilibrium(stiffness: float) -> None:
    rng = np.random.default_rng(1)
    pegs = [
        _slid(stiffness, bearing, beside_mm * MM)
        for bearing in (0.0, 0.8, 1.6, 3.1)
        for beside_mm in (0.0, 0.05)
    ]
    for reach_mm in [0.03] * 10 + [0.06] * 10:
        x_m, y_m = rng.uniform(-reach_mm * MM, reach_mm * MM, 2).tolist()
        pegs.append(_lowered(stiffness, x_m, y_m))
    steps = sum(peg.steps for peg in pegs)
    assert sum(peg.failures for peg in pegs) <= 0.01 * steps
    assert steps > 2000
