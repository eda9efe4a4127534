"""What the contracts of several kinds of devices share."""

from pathlib import Path

import pytest

from fakes.gentl.build import build_producer


@pytest.fixture(scope="session")
def producer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The fake GenTL producer, compiled once."""
    return build_producer(tmp_path_factory.mktemp("producer"))
