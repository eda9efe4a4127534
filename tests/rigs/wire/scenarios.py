"""Scenarios for tests on the wire."""

from fakes.scenario_file.scenario import Scenario


def as_on_a_real_cell(scenario: Scenario) -> Scenario:
    """The scenario with the dead man of a real cell: that of the demonstration, which shares its
    processors, waits longer."""
    robots = {
        name: robot.model_copy(update={"deadman_ms": 300})
        for name, robot in scenario.robots.items()
    }
    return scenario.model_copy(update={"robots": robots})
