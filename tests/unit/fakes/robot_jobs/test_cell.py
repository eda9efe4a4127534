"""A fake cell whose arms run the shipped jobs."""

from pathlib import Path

import pytest

from fakes.cell import Cell
from fakes.faults import JOB_FAULTS, ROBOT_FAULTS
from fakes.robot_jobs.controller import JobController
from fakes.scenes.load import load
from fakes.wire.sjl.controller import SjlController

CONFIG = Path(__file__).parents[4] / "config"
SMALL = CONFIG / "small.scenario.toml"


def test_the_scenario_says_what_a_controller_does() -> None:
    scenario = load(SMALL)
    assert {robot.controller for robot in scenario.robots.values()} == {"protocol"}
    jobs = scenario.with_controllers("jobs")
    assert {robot.controller for robot in jobs.robots.values()} == {"jobs"}
    assert jobs.model_dump(exclude={"robots"}) == scenario.model_dump(exclude={"robots"})


async def test_its_controllers_are_built_so() -> None:
    scenario = load(SMALL).model_copy(update={"cameras": {}, "stereo_cameras": {}})
    plain, jobs = Cell(scenario, 1), Cell(scenario.with_controllers("jobs"), 1)
    assert isinstance(plain.robots["arm"], SjlController)
    assert isinstance(jobs.robots["arm"], JobController)
    assert "acknowledge" not in plain.commands()
    assert "ARM-1" in str(jobs.robots["arm"]._programs["SJLMAIN"])


async def test_there_is_nothing_to_acknowledge_without_an_alarm() -> None:
    scenario = load(SMALL).model_copy(update={"cameras": {}, "stereo_cameras": {}})
    cell = Cell(scenario.with_controllers("jobs"), 1)
    for name in ("arm", "leg"):
        with pytest.raises(ValueError, match="shows no alarm"):
            cell.commands()["acknowledge"](robot=name)


def test_each_fault_of_the_jobs_is_one_of_a_robot() -> None:
    assert JOB_FAULTS.keys() < ROBOT_FAULTS.keys()
    assert not any(name.startswith("set_") for name in JOB_FAULTS)
