"""Scenarios for tests on the wire."""

from fakes.scenario_file.scenario import Scenario


def as_on_a_real_cell(scenario: Scenario) -> Scenario:
    """With the dead man of a real cell; the demonstration's is wider, it shares its processors."""
    robots = {
        name: robot.model_copy(update={"deadman_ms": 300})
        for name, robot in scenario.robots.items()
    }
    return scenario.model_copy(update={"robots": robots})
