"""The forwarder's view of the records of its cell."""

from pathlib import Path

import pytest

from cellctl.fleet.cell_records import CellRecords
from cellctl.records import RunStore
from tests.unit.records.conftest import start


@pytest.mark.parametrize("name", ["plain", "hall 3?", "50% done", "bay#2"])
def test_records_are_found_in_a_folder_of_any_name(tmp_path: Path, name: str) -> None:
    """In a URI these are other characters, and the file that they name then is another one."""
    store = RunStore(tmp_path / name)
    start(store)
    records = CellRecords(tmp_path / name)
    assert records.length() > 0
    records.close()
    store.close()
