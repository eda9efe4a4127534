from pathlib import Path

import pytest

from fakes.scenario import Scenario, load

SCENARIO = Path(__file__).parents[4] / "config" / "fake-cell.toml"


@pytest.fixture(scope="session")
def scenario() -> Scenario:
    return load(SCENARIO)
