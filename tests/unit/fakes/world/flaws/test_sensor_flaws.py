"""Each imperfection of the force sensor has the size that the catalogue says."""

import numpy as np
import pytest

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.flaws.sensor import SensorFlaws

RANGE_N = 5000.0


def flaws(scenario: DeckScenario, **scales: float) -> SensorFlaws:
    made = SensorFlaws.of(scenario.model_copy(update={"imperfections": scales}), "force")
    assert made is not None
    return made


def shown(sensor: SensorFlaws, forces_n: np.ndarray) -> np.ndarray:
    """Reading of Fz; each force stays long enough for the slow parts to be computed."""
    rows = []
    for force_n in forces_n:
        for _ in range(8):
            row = sensor.pass_on(np.array([0, 0, force_n, 0, 0, 0.0]))
        rows.append(row[2])
    return np.array(rows)


def test_an_ideal_sensor_has_none(scenario: DeckScenario) -> None:
    assert SensorFlaws.of(scenario, "force") is None


def test_nonlinearity_is_a_share_of_the_range(scenario: DeckScenario) -> None:
    forces_n = np.linspace(-RANGE_N, RANGE_N, 2001)
    deviation_n = shown(flaws(scenario, sensor_nonlinearity=1.0), forces_n) - forces_n
    assert np.abs(deviation_n).max() == pytest.approx(0.002 * RANGE_N, rel=1e-3)
    assert deviation_n[[0, 1000, -1]] == pytest.approx(0.0, abs=1e-9)


def test_hysteresis_parts_the_branches_of_a_full_cycle(scenario: DeckScenario) -> None:
    up_n = np.linspace(-RANGE_N, RANGE_N, 1001)
    cycle_n = np.concatenate([up_n[::-1], up_n, up_n[::-1]])
    rows = shown(flaws(scenario, sensor_hysteresis=1.0), cycle_n)
    rising, falling = rows[1001:2002], rows[2002:][::-1]
    width_n = np.abs(falling - rising)
    assert width_n.max() == pytest.approx(0.002 * RANGE_N, rel=0.05)


def test_hysteresis_is_small_over_a_mating(scenario: DeckScenario) -> None:
    sensor = flaws(scenario, sensor_hysteresis=1.0)
    loads_n = 1960.0 + np.concatenate([np.linspace(0, 40, 400), np.linspace(40, 0, 400)])
    rows = shown(sensor, loads_n)
    assert rows[399] - rows[0] == pytest.approx(40.0, abs=0.3)
    assert rows[799] == pytest.approx(rows[0], abs=0.3)


def test_lag_is_that_of_a_first_order_filter(scenario: DeckScenario) -> None:
    sensor = flaws(scenario, sensor_lag=5.0)
    sensor.pass_on(np.zeros(6))
    load = np.full(6, 100.0)
    rows = [sensor.pass_on(load)[2] for _ in range(40)]
    assert rows[4] == pytest.approx(100.0 * (1 - np.exp(-1.0)), rel=1e-6)


def test_a_load_that_stays_is_shown_in_the_end(scenario: DeckScenario) -> None:
    sensor = flaws(scenario, sensor_lag=1.0)
    sensor.pass_on(np.zeros(6))
    load = np.array([0.0, 0.0, 100.0, 0.0, 0.0, 0.0])
    rows = [sensor.pass_on(load) for _ in range(60)]
    assert rows[-1] is rows[-2]
    np.testing.assert_allclose(rows[-1], load, atol=1e-5)
