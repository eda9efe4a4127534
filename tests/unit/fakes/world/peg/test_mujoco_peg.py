"""Upright and little tilted pegs against MuJoCo."""

from pathlib import Path

import numpy as np
import pytest

from fakes.world.frames import Array
from tests.unit.fakes.world.peg.judge import DEPTH, F_X, F_Z, Push
from tests.unit.fakes.world.peg.pushing import MM, at_depth, pin, plug

_ABOVE_M = 0.2 * MM


@pytest.fixture(autouse=True)
def _no_log_in_the_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo drops MUJOCO_LOG.TXT where it runs."""
    monkeypatch.chdir(tmp_path)


def _both(push: Push, depth_m: float) -> tuple[Array, Array]:
    return push.in_the_fake(_ABOVE_M, -depth_m), push.in_mujoco(_ABOVE_M, -depth_m)


@pytest.mark.parametrize(
    "push",
    [
        pytest.param(Push(pin(0.05), 2e4, x_m=0.2 * MM), marks=pytest.mark.figures),
        pytest.param(Push(pin(0.02), 2e4, x_m=0.5 * MM), marks=pytest.mark.long),
        Push(plug(), 5e4, x_m=0.4 * MM),
    ],
)
def test_one_point_contact(push: Push) -> None:
    fake, judge = _both(push, 1.9 * MM)
    inside = judge[judge[:, DEPTH] > 1.5 * MM]
    assert fake[-1, F_X] == pytest.approx(inside[:, F_X].mean(), rel=0.1)
    assert fake[-1, F_Z] == pytest.approx(inside[:, F_Z].mean(), rel=0.1, abs=0.2)
    assert fake[:, F_Z].max() == pytest.approx(judge[:, F_Z].max(), rel=0.2)


@pytest.mark.long
@pytest.mark.parametrize(("clearance_mm", "tilt_deg"), [(0.02, 0.5), (0.05, 1.0)])
def test_two_point_contact(clearance_mm: float, tilt_deg: float) -> None:
    tilt = float(np.deg2rad(tilt_deg))
    push = Push(pin(clearance_mm), 2e4, 200.0, tilt_rad=tilt, speed_m_s=5e-3)
    fake, judge = _both(push, 9.1 * MM)
    for depth_mm in (8.0, 9.0):
        fake_n, judge_n = (at_depth(rows, depth_mm)[F_Z - 1] for rows in (fake, judge))
        assert fake_n == pytest.approx(judge_n, rel=0.25)
