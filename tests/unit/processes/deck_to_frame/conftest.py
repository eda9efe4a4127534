from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.unit.cell.bench import Bench, make_bench
from tests.unit.daemon_fixtures import rig as daemon_rig
from tests.unit.processes.deck_to_frame.rig import RunRig

__all__ = ["bench", "daemon_rig", "rig"]


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return make_bench(tmp_path)


@pytest.fixture
def rig(bench: Bench, tmp_path: Path) -> Iterator[RunRig]:
    rig = RunRig(bench, tmp_path / "store")
    yield rig
    rig.archive.close()
