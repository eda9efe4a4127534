"""`cellctl fleet` as its administrator, a cell and quality assurance use it."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from cellctl.cli.app import main
from cellctl.cli.fleet.app import app
from cellctl.errors.records.fleet import FleetNotNamed, FleetRefused
from cellctl.fleet import layout
from cellctl.fleet.address import PASSWORD as PASSWORD_VARIABLE
from cellctl.records import RunResult
from cellctl.records.entered.gauges import GAUGE_HOLES
from cellctl.records.entries import Document
from tests.rigs.postgres import OWNER, PASSWORD
from tests.unit.fleet.conftest import NORTH, SOUTH, Fleet, deliver_all
from tests.unit.records.conftest import start
from tests.unit.records.sample import good_run

SMALL = Path(__file__).parents[4] / "config" / "small.toml"


def run(*words: str, url: str = "") -> Result:
    env = {"COLUMNS": "160", "NO_COLOR": "1", "CELLCTL_FLEET": url}
    return CliRunner(env=env).invoke(app, words)


@pytest.fixture
def url(fleet: Fleet) -> str:
    """URL of a reader; both cells have runs."""
    for cell in (NORTH, SOUTH):
        store = fleet.store(cell)
        good_run(store)
        if cell == SOUTH:
            failed = start(store, "SAT-0042%")
            store.add_alarm(failed, 207, "F207 late")
            store.close_run(failed, RunResult.ABORTED, fault_number=304, fault="F304 moved on")
        deliver_all(fleet.delivery(cell))
    fleet.execute(f"GRANT {layout.READERS} TO quality")
    return fleet.server.url("quality", fleet.database)


FOUND: dict[tuple[str, ...], list[tuple[str, int]]] = {
    (): [(SOUTH, 2), (SOUTH, 1), (NORTH, 1)],
    ("--limit", "1"): [(SOUTH, 2)],
    ("--cell", NORTH): [(NORTH, 1)],
    ("--serial", "SAT-0042"): [(SOUTH, 1), (NORTH, 1)],
    ("--serial", "SAT-0042%"): [(SOUTH, 2)],
    ("--recipe", "panel 500 x 1000", "--operator", "OP-7", "--result", "good"): [
        (SOUTH, 1),
        (NORTH, 1),
    ],
    ("--fault", "207"): [(SOUTH, 2)],
    ("--fault", "304"): [(SOUTH, 2)],
    ("--calibration", "ef" * 32): [(SOUTH, 2)],
    ("--until", "2020-01-01"): [],
    ("--since", "2020-01-01", "--until", "2100-01-01", "--result", "aborted"): [(SOUTH, 2)],
}


def test_runs_of_all_cells_are_found(url: str) -> None:
    for words, found in FOUND.items():
        told = json.loads(run("runs", "--json", *words, url=url).stdout)
        assert [(one["cell"], one["number"]) for one in told] == found, words
    for words in ((), ("--limit", "1"), ("--until", "2020-01-01")):
        listed = run("runs", *words, url=url)
        assert len(re.findall(r"SAT-0042", listed.stdout)) == len(FOUND[words]), words


def test_a_part_that_a_gauge_has_spoilt_is_marked(url: str, fleet: Fleet) -> None:
    store = fleet.store(SOUTH)
    gauged = start(store, "SAT-0043")
    store.add(gauged, Document(GAUGE_HOLES, {"P1": {"least_mm": 5.9, "most_mm": 6.0}}))
    store.close_run(gauged, RunResult.GOOD)
    store.set_gauge(gauged, "P1", 5.85, "OP-7")
    deliver_all(fleet.delivery(SOUTH))
    listed = run("runs", url=url).stdout
    assert re.search(r"SAT-0043.*good, bad by gauge", listed)
    assert not re.search(r"SAT-0042.*bad by gauge", listed)
    told = {one["serial"]: one for one in json.loads(run("runs", "--json", url=url).stdout)}
    assert (told["SAT-0043"]["result"], told["SAT-0043"]["part_verdict"]) == ("good", "bad")
    shown = json.loads(run("show", SOUTH, str(gauged), "--json", url=url).stdout)
    assert shown["part_verdict"] == "bad"


def test_cells_show_and_verify(url: str, fleet: Fleet) -> None:
    cells = run("cells", url=url).stdout
    assert re.search(r"north cell\s+\d+\s+0\s+20\d\d-", cells)
    shown = run("show", SOUTH, "2", url=url).stdout
    assert "F304 moved on" in shown
    head = str(fleet.store(NORTH).ledger_head())
    verified = run("verify", "--cell", NORTH, "--head", head, url=url)
    assert (verified.exit_code, verified.stdout) == (0, "all records are as they were sealed\n")
    fleet.execute(f"UPDATE {fleet.places[SOUTH]}.runs SET fault = 'F101' WHERE ended IS NULL")
    fleet.execute(f"UPDATE {fleet.places[SOUTH]}.figures SET value = 0 WHERE key = 'peak_force'")
    verified = run("verify", url=url)
    assert verified.exit_code == 1
    assert "süd: 2: run 1 was changed after it was sealed\n" in verified.stdout
    unknown = run("verify", "--cell", "west", url=url)
    assert isinstance(unknown.exception, FleetRefused)
    assert "there are: north cell, süd: 2" in str(unknown.exception)


def test_nothing_that_is_typed_next_is_cut_at_80_columns(url: str, fleet: Fleet) -> None:
    narrow = CliRunner(env={"COLUMNS": "80", "NO_COLOR": "1", "CELLCTL_FLEET": url})
    listed = narrow.invoke(app, ["runs"]).stdout
    assert "…" not in listed
    assert "SAT-0042%" in listed
    assert max(map(len, listed.splitlines())) <= 80
    assert "…" not in narrow.invoke(app, ["cells"]).stdout


def test_the_help_is_whole_at_80_columns() -> None:
    words = [sys.executable, "-m", "cellctl", "fleet", "--help"]
    environment = os.environ | {"COLUMNS": "80"}
    told = subprocess.run(words, capture_output=True, text=True, check=True, env=environment).stdout
    _, _, commands = told.partition("Commands:")
    assert "verify" in commands
    assert "..." not in commands


def test_before_init_the_remedy_is_init(fleet: Fleet) -> None:
    fleet.server.execute(f"CREATE DATABASE {fleet.database}_bare")
    cells = run("cells", url=fleet.server.url(OWNER, f"{fleet.database}_bare"))
    assert isinstance(cells.exception, FleetRefused)
    assert "`cellctl fleet init` was never run on it" in str(cells.exception)
    assert "cellctl fleet init" in cells.exception.remedy


def test_from_an_empty_database_to_the_first_delivery(
    fleet: Fleet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fleet.server.execute(f"CREATE DATABASE {fleet.database}_new")
    owner = fleet.server.url(OWNER, f"{fleet.database}_new")
    assert "GRANT cellctl_fleet_reader" in run("init", url=owner).stdout
    assert "no cells" in run("cells", url=owner).stdout
    added = run("add", "small-cell", "--forwarder", "forward_north", url=owner)
    assert "cell_small_cell" in added.stdout
    assert run("migrate", url=owner).stdout == "all tables are of this version\n"
    monkeypatch.delenv(PASSWORD_VARIABLE)
    secret = tmp_path / "password"
    secret.write_text(f"{PASSWORD}\n", encoding="utf-8")
    text = SMALL.read_text(encoding="utf-8")
    text += f'\n[fleet]\nurl = "{fleet.server.url("forward_north", f"{fleet.database}_new")}"\n'
    text += f'password_file = "{secret}"\n'
    cell_file = tmp_path / "cell.toml"
    cell_file.write_text(text, encoding="utf-8")
    good_run(fleet.store(NORTH))
    folder = str(fleet.folder(NORTH))
    # A program of its own, as at a cell: it sets up the log of its process.
    words = ["-m", "cellctl", "fleet", "forward", str(cell_file), "--once", "--data-dir", folder]
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "entries of the ledger are delivered" in done.stdout
    verified = run("verify", "--password-file", str(secret), url=owner)
    assert verified.exit_code == 0, verified.exception


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("", "neither --store nor CELLCTL_FLEET is given"),
        ("postgresql://me:secret@host/db", "a password does not belong here"),
        ("postgresql://me@host/db?password=secret", "a password does not belong here"),
        ("mysql://me@host/db", "it reads postgresql://"),
        ("postgresql://me@host", "it reads postgresql://"),
        ("postgresql://host/db", "it reads postgresql://"),
        ("postgresql://me:secret@[host/db", "it reads postgresql://"),
    ],
)
def test_an_address_that_is_not_one(url: str, said: str) -> None:
    with pytest.raises(FleetNotNamed, match=re.escape(said)) as fault:
        CliRunner().invoke(app, ["cells", "--store", url], catch_exceptions=False)
    assert "secret" not in str(fault.value)


def test_a_cell_file_without_a_fleet_and_a_file_without_a_password(tmp_path: Path) -> None:
    with pytest.raises(FleetNotNamed, match="has no"):
        CliRunner().invoke(app, ["forward", str(SMALL), "--once"], catch_exceptions=False)
    empty = tmp_path / "password"
    empty.touch()
    words = ["cells", "--store", "postgresql://me@host/db", "--password-file"]
    for file, said in ((empty, "is empty"), (tmp_path / "none", "No such file")):
        with pytest.raises(FleetNotNamed, match=said):
            CliRunner().invoke(app, [*words, str(file)], catch_exceptions=False)


def test_without_the_library_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "psycopg", None)
    monkeypatch.setattr("sys.argv", ["cellctl", "fleet", "cells", "--store", "postgresql://a@b/c"])
    with pytest.raises(SystemExit):
        main()
    assert "pip install cellctl[fleet]" in capsys.readouterr().err
