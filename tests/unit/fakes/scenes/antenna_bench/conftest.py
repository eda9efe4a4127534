from pathlib import Path

import pytest

from fakes.scenes.antenna_bench.scenario import BenchScenario

CONFIG = Path(__file__).parents[5] / "config"


@pytest.fixture(scope="session")
def scenario() -> BenchScenario:
    """The shipped one."""
    return BenchScenario.read(CONFIG / "antenna.scenario.toml")
