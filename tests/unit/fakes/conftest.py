from pathlib import Path

import pytest

from fakes.scenes.deck_on_frame.scenario import DeckScenario

SCENARIO = Path(__file__).parents[3] / "config" / "deck.scenario.toml"


@pytest.fixture(scope="session")
def scenario() -> DeckScenario:
    return DeckScenario.read(SCENARIO)
