import pytest

from fakes.scenes.antenna_bench.scenario import BenchScenario


@pytest.fixture(scope="session")
def scenario(bench_scenario: BenchScenario) -> BenchScenario:
    """That of these tests."""
    return bench_scenario
