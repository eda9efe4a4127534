import pytest

from tests.unit.processes.antenna_module.steps.bench import Bench


@pytest.fixture
def bench() -> Bench:
    """A cell in which nothing is wrong."""
    return Bench()
