"""What the page is told of one run."""

import asyncio
import threading
from collections.abc import Iterator
from math import radians
from pathlib import Path

import pytest

from cellctl.errors.records.store import StoreUnavailable
from cellctl.hmi.archive import READERS, ArchiveReader
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
        "angle_error": "within threshold, as measured",
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


async def test_a_disk_that_hangs_is_a_fault_and_takes_no_more_threads(store: RunStore) -> None:
    """Signing in needs threads, too."""
    free, asked = threading.Event(), []

    def hang(_store: RunStore) -> int:
        asked.append(1)
        free.wait(60)
        return 7

    archive = ArchiveReader(store.path, answer_s=0.2)
    silent = [asyncio.create_task(archive.ask(hang)) for _ in range(READERS + 2)]
    answers = await asyncio.gather(*silent, return_exceptions=True)
    assert {type(one) for one in answers} == {StoreUnavailable}
    assert len(asked) == READERS, "those that it holds, and no others in their place"
    free.set()
    patient = ArchiveReader(store.path)
    assert await patient.ask(lambda found: len(found.runs())) == 0


async def test_a_reader_that_came_back_makes_room(store: RunStore) -> None:
    archive = ArchiveReader(store.path)

    def broken(_store: RunStore) -> None:
        raise StoreUnavailable("a test")

    for _ in range(READERS + 1):
        with pytest.raises(StoreUnavailable, match="a test"):
            await archive.ask(broken)
