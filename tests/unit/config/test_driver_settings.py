"""Staleness and rate of the force sensor must fit together before anything runs."""

import re
from pathlib import Path

from cellctl.config import load_cell, problems
from cellctl.config.driver_settings import sensor_rate_hz

CONFIG = Path(__file__).parents[3] / "config"


def slowed(tmp_path: Path, rate_hz: int) -> Path:
    text = (CONFIG / "deck.toml").read_text()
    (tmp_path / "features").symlink_to(CONFIG / "features")
    path = tmp_path / "cell.toml"
    slow = text.replace("rate_hz = 1000", f"rate_hz = {rate_hz}")
    path.write_text(re.sub(r"(?m)^stale_ms = \S+", "stale_ms = 150.0", slow))
    return path


def test_the_rate_is_the_one_in_the_settings_of_the_driver(tmp_path: Path) -> None:
    assert sensor_rate_hz(load_cell(slowed(tmp_path, 250)).force_sensors["force"]) == 250.0


def test_a_sensor_may_not_be_slower_than_its_silence(tmp_path: Path) -> None:
    text = slowed(tmp_path, 250).read_text().replace("stale_ms = 150.0", "stale_ms = 5.0")
    (tmp_path / "cell.toml").write_text(text)
    [problem] = problems(tmp_path / "cell.toml")
    assert problem.key == "force_sensors.force.stale_ms"
    assert problem.allowed == "at least 8, two samples at the sensor's rate"
    (rate,) = problem.against
    assert (rate.key, rate.allowed) == ("force_sensors.force.settings.rate_hz", "at least 400")


def test_of_a_sensor_that_is_too_slow_no_longer_silence_is_asked_for(tmp_path: Path) -> None:
    [problem] = problems(slowed(tmp_path, 10))
    assert problem.key == "force_sensors.force.settings.rate_hz"
    assert problem.allowed.startswith("at least 100 samples a second")
