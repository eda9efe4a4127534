"""What the contracts of several kinds of devices share."""

from pathlib import Path

import pytest

from tests.rigs.wire.producer import built_once


@pytest.fixture(scope="session")
def producer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The fake GenTL producer, compiled once."""
    return built_once(tmp_path_factory)
