"""Settling on simulated time."""

from typing import cast

import numpy as np
import pytest

from cellctl.cell.guarded_motion.settling import block_scatter, settle
from cellctl.errors.force import GuardDied, NotSettled, SensorFrozen
from cellctl.guard.client import GuardClient
from cellctl.guard.report import GuardSamples
from cellctl.guard.settling import Settling
from tests.rigs.mating.simulated_loop import run_simulated

PERIOD_S = 1e-3


class Swinging:
    """A payload whose swing dies away; samples exist up to the present of the simulation."""

    def __init__(self, amplitude_n: float, decay_s: float, noise_n: float = 0.3) -> None:
        self.settling = Settling()
        self.now_s = 0.0
        self.asked_since: list[float] = []
        self._swing = amplitude_n, decay_s
        self._noise = np.random.default_rng(0).normal(0.0, noise_n, (20_000, 6))

    def samples(self, since_s: float) -> GuardSamples:
        self.asked_since.append(since_s)
        amplitude_n, decay_s = self._swing
        time_s = np.arange(since_s, self.now_s, PERIOD_S)
        swing = amplitude_n * np.exp(-time_s / decay_s) * np.sin(2 * np.pi * 4.0 * time_s)
        raw = self._noise[: len(time_s)] + swing[:, None]
        return GuardSamples(time_s, raw, raw, np.zeros(len(time_s)), overrun=False)


def settled_after(guard: Swinging) -> float:
    def advance(to_s: float) -> None:
        guard.now_s = to_s

    run_simulated(0.0, advance, lambda: settle(cast(GuardClient, guard)))
    return guard.now_s


def test_a_still_payload_needs_one_window() -> None:
    assert settled_after(Swinging(0.0, 1.0)) == pytest.approx(Settling().window_s, abs=0.11)


def test_a_swinging_payload_is_waited_for() -> None:
    guard = Swinging(60.0, 0.8)
    end_s = settled_after(guard)
    assert 1.5 < end_s < Settling().timeout_s
    assert 60.0 * np.exp(-(end_s - Settling().window_s) / 0.8) / np.sqrt(2) < 2.5
    assert min(guard.asked_since) >= 0.0, "nothing from before the motion's end counts"


def test_a_payload_that_never_rests_is_a_fault() -> None:
    with pytest.raises(NotSettled, match="scatter"):
        settled_after(Swinging(20.0, 1e9))


def test_a_frozen_sensor_is_not_still() -> None:
    with pytest.raises(SensorFrozen):
        settled_after(Swinging(0.0, 1.0, noise_n=0.0))


def test_missing_samples_are_not_stillness() -> None:
    guard = Swinging(0.0, 1.0)
    guard.samples = lambda since_s: GuardSamples(  # type: ignore[method-assign]
        np.zeros(0), np.zeros((0, 6)), np.zeros((0, 6)), np.zeros(0), overrun=False
    )
    with pytest.raises(NotSettled, match="inf"):
        settled_after(guard)


def test_the_death_of_the_guard_is_raised() -> None:
    class Dead(Swinging):
        def samples(self, since_s: float) -> GuardSamples:
            raise GuardDied("killed")

    with pytest.raises(GuardDied):
        settled_after(Dead(0.0, 1.0))


def test_scatter_needs_two_blocks() -> None:
    assert np.isinf(block_scatter(np.zeros((19, 6)))).all()
    assert block_scatter(np.repeat([[1.0] * 6, [3.0] * 6], 10, axis=0)) == pytest.approx(1.0)
