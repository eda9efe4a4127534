"""What the page is told of one run."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

import pytest

from cellctl.hmi.archive import ArchiveReader
from cellctl.records import RunStore
from cellctl.records.figures import KNOWN_TO, Limit, figure
from tests.unit.records.conftest import start


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


def test_figures_have_the_verdicts_that_report_and_terminal_show(store: RunStore) -> None:
    run = start(store)
    store.add(
        run,
        figure("angle_error", 0.004, "°", limit=Limit(upper=0.006)),
        figure(f"angle_error{KNOWN_TO}", 0.0031, "°"),
        figure("peak_force", 61.0, "N", limit=Limit(upper=50.0)),
    )
    told = asyncio.run(ArchiveReader(store.path).run(run))
    assert {one["key"]: one["verdict"] for one in told["figures"]} == {
        "angle_error": "not decided",
        f"angle_error{KNOWN_TO}": None,
        "peak_force": "fail",
    }
