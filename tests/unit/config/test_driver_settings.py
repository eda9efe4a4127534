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
    [problem] = problems(slowed(tmp_path, 10))
    assert problem.key == "force_sensors.force.stale_ms"
    assert problem.allowed == "at least 200, two samples at the sensor's rate"
