from pathlib import Path

import pytest

from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.deck_on_frame.scenario import DeckScenario

CONFIG = Path(__file__).parents[3] / "config"


@pytest.fixture(scope="session")
def shipped_scenario() -> DeckScenario:
    """The scenario as the demonstration has it."""
    return DeckScenario.read(CONFIG / "deck.scenario.toml")


@pytest.fixture(scope="session")
def scenario(shipped_scenario: DeckScenario) -> DeckScenario:
    """The scenario without the imperfections that have a test of their own each."""
    return shipped_scenario.without_imperfections()


@pytest.fixture(scope="session")
def bench_scenario() -> BenchScenario:
    """The antenna bench as it is shipped."""
    return BenchScenario.read(CONFIG / "antenna.scenario.toml")
