"""What the page is told of one run."""

import asyncio
from collections.abc import Iterator
from math import radians
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


def test_figures_have_the_units_of_the_report(store: RunStore) -> None:
    run = start(store)
    store.add(
        run,
        figure("tilt", radians(0.25), "rad", limit=Limit(upper=radians(0.5))),
        figure("depth", 0.0041, "m", limit=Limit(0.004, 0.005)),
        figure("stiffness", None, "N/m"),
        figure("peak_force", 41.0, "N", limit=Limit(upper=50.0)),
    )
    told = asyncio.run(ArchiveReader(store.path).run(run))["figures"]
    tilt, depth, stiffness, force = told
    assert [one["unit"] for one in told] == ["°", "mm", "N/mm", "N"]
    assert (tilt["value"], tilt["lower"]) == (pytest.approx(0.25), None)
    assert tilt["upper"] == pytest.approx(0.5)
    assert [depth[part] for part in ("value", "lower", "upper")] == pytest.approx([4.1, 4.0, 5.0])
    assert stiffness["value"] is None
    assert (force["value"], force["upper"], force["verdict"]) == (41.0, 50.0, "pass")
