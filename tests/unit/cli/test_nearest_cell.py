"""Commands find the store and the socket of the cell that somebody has just worked with."""

import os
import socket
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli import nearest_cell
from cellctl.cli.nearest_cell import nearest_socket, nearest_store
from cellctl.cli.operator.daemon_client import DaemonClient
from cellctl.cli.records.runs import app
from cellctl.errors.local import DaemonNotReached
from cellctl.errors.records.store import StoreUnavailable
from cellctl.records import RunStore
from tests.unit.records.sample import good_run


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in, on a machine without the service."""
    monkeypatch.setattr(nearest_cell, "SERVICE_STORE", tmp_path / "var")
    monkeypatch.setattr(nearest_cell, "SERVICE_SOCKET", tmp_path / "run" / "cellctl.sock")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def left_by(folder: Path, name: str, age_s: float) -> Path:
    """A file that was written so long ago."""
    folder.mkdir(parents=True)
    file = folder / name
    file.touch()
    os.utime(file, (1e9 - age_s, 1e9 - age_s))
    return file


def test_the_newest_demonstration_is_meant(here: Path) -> None:
    left_by(Path("runs/first/store"), "store.sqlite", age_s=60.0)
    newest = left_by(Path("runs/second/store"), "store.sqlite", age_s=10.0)
    assert nearest_store() == newest.parent


def test_the_service_goes_before_what_was_started_here(here: Path) -> None:
    left_by(Path("runs"), "store.sqlite", age_s=0.0)
    left_by(here / "var", "store.sqlite", age_s=60.0)
    assert nearest_store() == here / "var"
    left_by(Path("runs/demo/store"), "cellctl.sock", age_s=0.0)
    service = left_by(here / "run", "cellctl.sock", age_s=60.0)
    assert nearest_socket() == service


def test_a_daemon_that_was_started_here_is_found(here: Path) -> None:
    left = left_by(Path("runs/demo/store"), "cellctl.sock", age_s=0.0)
    assert nearest_socket() == left


def test_a_shipped_cell_file_that_was_started_here_is_found(here: Path) -> None:
    """Its data_dir is the store itself, as ``runs/small``."""
    store = left_by(Path("runs/small"), "store.sqlite", age_s=0.0)
    (store.parent / "cellctl.sock").touch()
    assert nearest_store() == store.parent
    assert nearest_socket() == store.parent / "cellctl.sock"


def test_a_daemon_that_is_not_found_is_told_with_the_places(here: Path) -> None:
    with pytest.raises(DaemonNotReached, match=r"runs/\*/store; a daemon has its socket in"):
        DaemonClient(None).status()
    with pytest.raises(DaemonNotReached, match=r"named.sock: No such file or directory$"):
        DaemonClient(Path("named.sock")).status()


def test_without_any_the_places_are_named(here: Path) -> None:
    with pytest.raises(StoreUnavailable, match=r"run.* runs/\*, .*--data-dir"):
        nearest_store()
    assert nearest_socket() == nearest_cell.SERVICE_SOCKET


def test_runs_are_listed_without_naming_a_folder(here: Path) -> None:
    store = RunStore(Path("runs/demo/store"))
    good_run(store)
    store.close()
    done = CliRunner().invoke(app, ["list"])
    assert done.exit_code == 0
    assert "SAT-0042" in done.stdout
    assert "runs/demo/store" in done.stderr


def test_a_live_daemon_is_found_beside_a_newer_socket_that_nobody_answers(here: Path) -> None:
    live = Path("runs/live/store/cellctl.sock")
    live.parent.mkdir(parents=True)
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listening:
        listening.bind(str(live))
        listening.listen()
        left_by(Path("runs/dead/store"), "cellctl.sock", age_s=-1e9)
        left_by(here / "run", "cellctl.sock", age_s=0.0)
        assert nearest_socket() == live
