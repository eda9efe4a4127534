"""The template of an antenna cell with GigE cameras: what is plugged and how is the fake cell's."""

import tomllib
from pathlib import Path
from typing import Any

import pytest

from cellctl.config.load import load_cell
from cellctl.processes.antenna_module.stations import antenna_recipes
from drivers.camera.gige.config import GigeCameraConfig

CONFIG = Path(__file__).parents[3] / "config"
TEMPLATE, FAKE = CONFIG / "antenna-gige.toml", CONFIG / "antenna.toml"


def read(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def test_recipe_and_taught_poses_are_those_of_the_fake_cell() -> None:
    own, fake = read(TEMPLATE), read(FAKE)
    assert own["recipes"] == fake["recipes"]
    assert own["robots"]["arm"]["poses_deg"] == fake["robots"]["arm"]["poses_deg"]
    assert antenna_recipes(load_cell(TEMPLATE)) == antenna_recipes(load_cell(FAKE))


def test_nothing_in_it_is_simulated() -> None:
    assert "simulated" not in TEMPLATE.read_text(encoding="utf-8")
    assert not load_cell(TEMPLATE).simulated


def test_its_cameras_are_two_and_send_what_is_measured() -> None:
    settings = [
        GigeCameraConfig.model_validate(camera["settings"])
        for camera in read(TEMPLATE)["cameras"].values()
    ]
    assert len({one.camera.serial_number for one in settings}) == 2
    assert {one.pixel_format for one in settings} == {"Mono8"}


@pytest.mark.parametrize("key", ["producers", "camera.serial_number", "exposure_s"])
def test_what_no_template_can_know_is_marked(key: str) -> None:
    text = TEMPLATE.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line.startswith(f"{key} =")]
    assert len(lines) == 2
    assert all("# FILL IN" in line for line in lines)
