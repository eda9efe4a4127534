"""The cell of the mating campaign is that of the demonstration."""

from tests.rigs.mating.cell import SCENARIO


def test_its_scenario_is_there() -> None:
    assert SCENARIO.is_file()
