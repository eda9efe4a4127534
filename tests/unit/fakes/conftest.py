from pathlib import Path

import pytest

from fakes.scenes.deck_on_frame.scenario import DeckScenario

SCENARIO = Path(__file__).parents[3] / "config" / "deck.scenario.toml"


@pytest.fixture(scope="session")
def shipped_scenario() -> DeckScenario:
    """As the demonstration has it."""
    return DeckScenario.read(SCENARIO)


@pytest.fixture(scope="session")
def scenario(shipped_scenario: DeckScenario) -> DeckScenario:
    """Without the imperfections that have a test of their own each."""
    return shipped_scenario.without_imperfections()
