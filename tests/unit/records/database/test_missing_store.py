"""The folder above a run store is named with the one that is meant."""

from pathlib import Path

import pytest

from cellctl.errors.records.store import StoreUnavailable
from cellctl.records.run_list import listed_runs
from cellctl.records.store import RunStore


def test_the_store_below_the_folder_of_a_demonstration_is_named(tmp_path: Path) -> None:
    RunStore(tmp_path / "store").close()
    for opened in (lambda: listed_runs(tmp_path, 5), lambda: RunStore(tmp_path, create=False)):
        with pytest.raises(StoreUnavailable, match=f"did you mean {tmp_path / 'store'}"):
            opened()


def test_where_none_is_nothing_is_proposed(tmp_path: Path) -> None:
    with pytest.raises(StoreUnavailable) as raised:
        listed_runs(tmp_path, 5)
    assert "mean" not in raised.value.detail
