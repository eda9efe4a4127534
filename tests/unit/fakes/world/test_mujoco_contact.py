"""MuJoCo as an independent opinion on the fake's contact: press calibration, then dynamics."""

from pathlib import Path

import numpy as np
import pytest

from tests.rigs.sweeps import sweep
from tests.unit.fakes.world.mujoco_rig import Oracle, Travel, rig

PEAK, CURVE = 0.03, 0.03
"""Allowed difference of peaks, and rms difference of the whole curves relative to the peak."""


@pytest.fixture(autouse=True)
def _no_log_in_the_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo drops MUJOCO_LOG.TXT where it runs."""
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("contact_n_m", sweep((1e5, 3e6, 1e7), (3e6,)))
def test_press_calibration(contact_n_m: float) -> None:
    oracle = Oracle(rig(contact_n_m))
    assert oracle.pressed_n_m == pytest.approx(contact_n_m, rel=0.02)


@pytest.mark.parametrize(
    "contact_n_m",
    [1e6, *(pytest.param(value, marks=pytest.mark.long) for value in (1e5, 3e5, 3e6, 1e7))],
)
def test_forces_agree_at_every_moment(contact_n_m: float) -> None:
    """Slow pushes as in mating, and impacts far beyond it; peaks are what matters most."""
    here = rig(contact_n_m)
    oracle = Oracle(here)
    series = 1.0 / (1.0 / contact_n_m + 1e-6)
    for speed_m_s, force_n in ((1e-4, 38.0), (3e-4, 45.0), (1e-3, 60.0), (2e-3, 90.0)):
        travel = Travel(speed_m_s, force_n / series)
        seconds = round(travel.end_s + 0.25, 3)
        fake, independent = here.fake_force(travel, seconds), oracle.force(travel, seconds)
        assert fake.max() == pytest.approx(independent.max(), rel=PEAK), (speed_m_s, force_n)
        assert fake.max() > 0.9 * force_n
        assert fake[-1] == pytest.approx(independent[-1], rel=PEAK)
        apart_n = float(np.sqrt(np.mean((fake - independent) ** 2)))
        assert apart_n < CURVE * fake.max(), (speed_m_s, force_n)


def test_a_tilted_deck_touches_pad_by_pad_in_both() -> None:
    here = rig(3e6, tilt_deg=(0.004, 0.005))
    oracle = Oracle(here)
    travel = Travel(2e-4, 8e-5)
    seconds = round(travel.end_s + 0.25, 3)
    fake, independent = here.fake_force(travel, seconds), oracle.force(travel, seconds)
    assert fake[-1] == pytest.approx(independent[-1], rel=PEAK)
    assert fake.max() == pytest.approx(independent.max(), rel=PEAK)
    assert fake[-1] < 0.8 * 8e-5 * 7.5e5, "an edge is softer than the whole face"
