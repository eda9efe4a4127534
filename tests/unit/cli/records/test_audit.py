"""`cellctl audit`: who did what, newest first, for people and for programs."""

import json
from contextlib import closing
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.records.store import RunStore


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A store in which two people did three things."""
    with closing(RunStore(tmp_path)) as store:
        store.audit("terminal:li", "start", {"serial": "SAT-1"})
        store.audit("terminal:wang", "gauge", {"run": 1, "hole": "P1"})
        store.audit("terminal:li", "abort")
    return tmp_path


def said(folder: Path, *words: str) -> str:
    done = CliRunner().invoke(whole_app(), ["audit", "--data-dir", str(folder), *words])
    assert done.exit_code == 0, done.output
    return done.stdout


def test_the_newest_entry_comes_first(folder: Path) -> None:
    text = said(folder)
    assert text.index("abort") < text.index("gauge") < text.index("start")
    assert "serial SAT-1" in text


def test_entries_are_chosen_by_who_and_what(folder: Path) -> None:
    assert "wang" not in said(folder, "--who", "li")
    entries = json.loads(said(folder, "--action", "gauge", "--json"))
    assert [(one["actor"], one["detail"]["hole"]) for one in entries] == [("terminal:wang", "P1")]
    assert len(json.loads(said(folder, "--limit", "2", "--json"))) == 2
    assert "no such entries, of 3" in said(folder, "--action", "reset")


def test_brackets_that_people_type_are_shown(folder: Path) -> None:
    with closing(RunStore(folder)) as store:
        store.audit("terminal:li", "note", {"remark": "seal [red] broken [/see 7]"})
    assert "seal [red] broken [/see 7]" in said(folder, "--action", "note")


def test_a_mistyped_folder_makes_no_store(tmp_path: Path) -> None:
    absent = tmp_path / "absent"
    done = CliRunner().invoke(whole_app(), ["audit", "--data-dir", str(absent)])
    assert done.exit_code != 0
    assert not absent.exists()
