"""Where the database of a store lies."""

from pathlib import Path

import pytest

from cellctl.records import RunStore
from tests.unit.records.conftest import start


@pytest.mark.parametrize("name", ["plain", "hall 3?", "50% done", "bay#2", "a?mode=memory"])
def test_the_database_lies_in_its_folder_whatever_that_is_called(tmp_path: Path, name: str) -> None:
    """In a text of an address a question mark ends the path: records lay beside the folder."""
    store = RunStore(tmp_path / name)
    start(store)
    store.close()
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name / "store.sqlite").exists()
