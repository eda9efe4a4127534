import time

import numpy as np
import pytest

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.world.load.sensor import ForceReading
from fakes.world.truth import draw
from tests.unit.fakes.world.driving import hovering, mean_reading, to_taught


def quiet(scenario: DeckScenario) -> DeckScenario:
    """No noise, ideal sensor, mounted true."""
    nothing = dict.fromkeys(
        (
            "mounting_sigma_deg", "noise_n", "noise_nm", "vibration_n", "gain_sigma",
            "crosstalk_sigma", "offset_sigma_n", "offset_sigma_nm", "drift_n_per_min",
            "drift_nm_per_min",
        ),
        0.0,
    )  # fmt: skip
    sensor = scenario.force_sensors["force"].model_copy(update=nothing)
    return scenario.model_copy(update={"force_sensors": {"force": sensor}})


def test_ideal_sensor_reads_weight_and_its_moment(scenario: DeckScenario) -> None:
    world = DeckOnFrame(quiet(scenario), 1)
    to_taught(world, "main", "deck_measure")
    world.advance(world.time_s + 3)
    fx, fy, fz, mx, my, mz = mean_reading(world, 50)
    weight = 200 * 9.80665
    assert np.hypot(np.hypot(fx, fy), fz) == pytest.approx(weight, rel=1e-6)
    assert fz == pytest.approx(weight, rel=1e-3)
    com = np.array(scenario.payload.com_in_sensor_mm) / 1000
    np.testing.assert_allclose([mx, my, mz], np.cross(com, [fx, fy, fz]), atol=1e-6)


def test_less_weight_without_the_deck(scenario: DeckScenario) -> None:
    world = DeckOnFrame(quiet(scenario), 1)
    world.set_present(deck=False)
    world.advance(1.0)
    assert np.linalg.norm(world.sensor_wrench("force", 1.0)[:3]) == pytest.approx(
        150 * 9.80665, rel=1e-6
    )


def test_acceleration_is_felt(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(quiet(scenario), 1))
    rest = world.sensor_wrench("force", world.time_s)
    arm = world.arms["main"]
    start = world.time_s
    target = arm.encoder_pose(start)
    target = type(target).from_translation([0, 0, 0.2]) * target
    arm.start_linear(start, target, 0.5, 0.5)
    readings = np.array([world.sensor_wrench("force", start + 1e-3 * k) for k in range(150, 530)])
    assert (readings - rest)[:, 2].mean() == pytest.approx(200 * 0.5, rel=0.25)


def test_noise_has_its_size_and_is_the_same_again(scenario: DeckScenario) -> None:
    truth = draw(scenario, 3).force_sensors["force"]
    reading, again = (ForceReading(scenario.force_sensors["force"], truth, 3) for _ in range(2))
    times = np.arange(0, 8, 1e-3)
    rows = np.array([reading.read(np.zeros(6), t) for t in times])
    np.testing.assert_array_equal(rows[777], again.read(np.zeros(6), times[777]))
    settings = scenario.force_sensors["force"]
    expected = np.hypot(settings.noise_n, settings.vibration_n)
    np.testing.assert_allclose(rows[:, :3].std(axis=0), expected, rtol=0.05)


def test_saturates_at_its_range(scenario: DeckScenario) -> None:
    reading = ForceReading(
        scenario.force_sensors["force"], draw(scenario, 3).force_sensors["force"], 3
    )
    rows = reading.read(np.array([1e5, -1e5, 0, 0, 0, 1e4]), 1.0)
    assert rows[0] == 5000
    assert rows[1] == -5000
    assert rows[5] == 1000


def test_standing_world_costs_almost_nothing(scenario: DeckScenario) -> None:
    world = DeckOnFrame(quiet(scenario), 1)
    world.advance(2.0)
    began_s = time.process_time()
    world.advance(62.0)
    assert time.process_time() - began_s < 0.1 * 60.0
