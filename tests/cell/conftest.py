"""Cells of a test's own; nothing of them outlives the test."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.guides.weighing import installed, small, written
from tests.rigs.whole_cell.own_cell import OwnCell

__all__ = ["antenna", "installed", "own", "small", "standing", "visited", "written"]


@pytest.fixture
def own(tmp_path: Path) -> Iterator[OwnCell]:
    """Files and ports for a cell; the test starts what it needs of it."""
    cell = OwnCell.make(tmp_path)
    yield cell
    cell.kill_all()


@pytest.fixture
def antenna(tmp_path: Path) -> Iterator[OwnCell]:
    """The same for the antenna's cell."""
    cell = OwnCell.make(tmp_path, "antenna")
    yield cell
    cell.kill_all()


@pytest.fixture(scope="session")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OwnCell]:
    """A fake cell that stands for many tests, as a real one would; each brings its daemon."""
    cell = OwnCell.make(tmp_path_factory.mktemp("standing"))
    cell.fake().ready()
    yield cell
    cell.kill_all()


@pytest.fixture
def visited(standing: OwnCell, tmp_path: Path) -> Iterator[OwnCell]:
    """The standing cell with a cell file and a store of this test, and nothing wrong with it."""
    cell = standing.visited_from(tmp_path)
    yield cell
    cell.kill_all()
    with cell.control() as control:
        for device in ("main", "aux_1", "aux_2", "force", "head_1", "head_2", "tracker"):
            control.request("clear", device=device)
        control.request("present", frame=True, deck=True)
        control.request("load")
