"""A store of schema 2, as its own code wrote it, opens without loss and gets all of its seals."""

import json
import shutil
import sqlite3
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import pytest

from cellctl.records import RunStore
from cellctl.records.database.migration import backup_of

OLD = Path(__file__).parents[3] / "data" / "store-v2"


@pytest.fixture
def old(tmp_path: Path) -> Path:
    return Path(shutil.copytree(OLD, tmp_path / "old"))


@pytest.fixture
def store(old: Path) -> Iterator[RunStore]:
    store = RunStore(old, create=False)
    yield store
    store.close()


@pytest.mark.parametrize("number", [1, 2, 3])
def test_every_run_is_as_it_was(store: RunStore, number: int) -> None:
    expected = json.loads((OLD / "expected.json").read_text(encoding="utf-8"))[number - 1]
    found = json.loads(json.dumps(asdict(store.run(number)), default=str))
    for gauge in found["gauges"]:
        assert gauge.pop("gauge_id") is None
    for name, value in expected.items():
        assert found[name] == value, name


def test_what_had_no_seal_gets_one(store: RunStore, old: Path) -> None:
    assert store.verify() == []
    assert store.ledger_head().length > 4
    assert backup_of(old / "store.sqlite", 2).exists()
    for statement in (
        "UPDATE audit SET actor = 'x' WHERE id = 1",
        "UPDATE alarms SET text = 'x' WHERE id = 2",
        "UPDATE calibrations SET valid_until = '2099-01-01 00:00:00.000000'",
        "UPDATE gauges SET gauge_id = 'PG-1'",
    ):
        before = store.verify()
        with sqlite3.connect(old / "store.sqlite") as connection:
            connection.execute(statement)
        connection.close()
        assert len(store.verify()) > len(before), statement


def test_the_open_run_of_before_is_closed(store: RunStore) -> None:
    assert store.mark_interrupted() == [3]
    assert store.verify() == []
