"""The deck cell on the shipped job files: as that of the demonstration, but for the permit loop."""

import tomllib
from pathlib import Path
from typing import Any

from fakes.scenes.load import load

CONFIG = Path(__file__).parents[3] / "config"


def read(name: str) -> dict[str, Any]:
    return tomllib.loads((CONFIG / name).read_text())


def test_all_but_the_contacts_is_as_in_the_demonstration() -> None:
    own, general = read("deck-jobs.toml"), read("deck.toml")
    assert own.pop("digital_ios").keys() == {"permit"}
    assert all(robot.pop("permit") for robot in own["robots"].values())
    for name in ("name", "data_dir"):
        assert own.pop(name) != general.pop(name)
    assert own == general


def test_each_contact_is_wired_to_the_arm_that_the_cell_file_says() -> None:
    own, fake = read("deck-jobs.toml"), load(CONFIG / "deck-jobs.scenario.toml")
    outputs = own["digital_ios"]["permit"]["settings"]["outputs"]
    wired = {name: robot.permit.output for name, robot in fake.robots.items() if robot.permit}
    assert wired == {
        name: outputs[robot["permit"]["output"]] for name, robot in own["robots"].items()
    }
    assert {robot.controller for robot in fake.robots.values()} == {"jobs"}
