"""Files that are made on demand, each in a process of its own."""

import gc
import json
import os
import tempfile
from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import pytest

from cellctl.hmi.problems import Problem
from cellctl.hmi.routes.exports import FileToKeep, RunExporter
from cellctl.records.store import RunStore
from tests.unit.hmi.http_client import Client
from tests.unit.hmi.in_process import answered
from tests.unit.records.sample import good_run

FORM = ("--mcap", "--images", "none")


@pytest.fixture
def data_dir(tmp_path: Path) -> Path:
    store = RunStore(tmp_path / "store")
    good_run(store, b"\x89PNG")
    store.close()
    return tmp_path / "store"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where exports are made."""
    folder = tmp_path / "exports"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


async def test_only_so_many_at_once(data_dir: Path, folder: Path) -> None:
    exporter = RunExporter(data_dir, at_once=1)
    async with exporter.made(1, FORM, "a.mcap", 60.0) as made:
        assert (made / "a.mcap").stat().st_size > 1000
        with pytest.raises(Problem) as busy:
            async with exporter.made(1, FORM, "b.mcap", 60.0):
                pass
        assert busy.value.status == 429
        assert int(busy.value.headers["Retry-After"]) >= 1
    assert os.listdir(folder) == []


async def test_one_that_failed_leaves_nothing_and_makes_room(data_dir: Path, folder: Path) -> None:
    exporter = RunExporter(data_dir, at_once=1)
    for number, limit_s, status, words in ((1, 0.01, 504, "0.01 s"), (99, 60.0, 500, "F804")):
        with pytest.raises(Problem, match=words) as failed:
            async with exporter.made(number, FORM, "a.mcap", limit_s):
                pass
        assert failed.value.status == status
    assert os.listdir(folder) == []


def test_the_record_of_a_run_is_an_archive_to_keep(page: Client) -> None:
    record = page.get("runs/1/record.zip")
    assert (record.status, record.headers["content-type"]) == (200, "application/zip")
    assert 'filename="run-1.zip"' in record.headers["content-disposition"]
    with ZipFile(BytesIO(record.body)) as packed:
        assert packed.testzip() is None
        assert {"run.json", "report.html", "look.png", "page.html"} <= set(packed.namelist())
        assert json.loads(packed.read("run.json"))["simulated"] is True
    assert page.get("runs/99/record.zip").status == 404


async def test_a_file_is_closed_when_whoever_asked_has_gone(tmp_path: Path) -> None:
    (tmp_path / "large").write_bytes(bytes(2**20))
    told = FileToKeep(tmp_path / "large", "large", "application/zip")
    scope = {"type": "http", "method": "GET", "headers": []}
    reply = await answered(told, scope, stays=True)
    assert len(reply.body) == 2**20
    gone = FileToKeep(tmp_path / "large", "large", "application/zip")
    await answered(gone, scope, stays=False)
    # Python warns of a file that nobody has closed, and a warning is an error here.
    del told, gone
    gc.collect()
