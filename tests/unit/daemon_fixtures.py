"""Fixtures of every test that needs the daemon's unit around a cell in memory."""

from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from tests.unit.cell.bench import Bench, make_bench
from tests.unit.daemon_rig import DaemonRig


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return make_bench(tmp_path)


@pytest.fixture
async def rig(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> AsyncIterator[DaemonRig]:
    """An open unit on a store of its own."""
    rig = DaemonRig(bench, tmp_path / "store", monkeypatch)
    await rig.open()
    yield rig
    await rig.close()
