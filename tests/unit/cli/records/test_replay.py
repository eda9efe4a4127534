"""`cellctl replay`: what it refuses, with which words."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.errors.records.store import NotReplayable
from cellctl.processes.deck_to_frame.process import DeckToFrame
from cellctl.records import RunResult, RunStore
from cellctl.records.entries import MAINTENANCE
from cellctl.records.files.artefacts import CELL_FILE
from tests.unit.records.conftest import start


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


@pytest.mark.parametrize(
    ("process", "words"),
    [
        ("antenna-module", "does not have the planes in which its images were measured"),
        ("peg-in-hole", "has every tick, and not which of them a touch, a chirp"),
        ("milling", "the process milling is not installed"),
    ],
)
def test_a_run_that_cannot_be_computed_anew_is_refused(
    store: RunStore, process: str, words: str
) -> None:
    store.close_run(start(store, process=process), RunResult.GOOD)
    refused = CliRunner().invoke(whole_app(), ["replay", "1", "--data-dir", str(store.path)])
    assert isinstance(refused.exception, NotReplayable)
    assert refused.exception.number == 813
    assert words in refused.exception.detail


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        (None, "cell.json is not in the record"),
        ({}, "no installed process of its cell (none) computes anew"),
        ({"milling": {}}, "no installed process of its cell (milling) computes anew"),
        # It has procedures, and none of this number.
        ({"milling": {}, "deck-to-frame": {}}, "(milling, deck-to-frame) computes anew"),
    ],
)
def test_a_procedure_that_no_process_of_its_cell_computes_anew_is_refused(
    store: RunStore, cell: dict[str, object] | None, words: str
) -> None:
    run = start(store, process=MAINTENANCE, mode=MAINTENANCE)
    if cell is not None:
        data = json.dumps({"processes": cell}).encode()
        store.add_artefact(run, CELL_FILE, data, "application/json")
    store.close_run(run, RunResult.GOOD)
    refused = CliRunner().invoke(whole_app(), ["replay", "1", "--data-dir", str(store.path)])
    assert isinstance(refused.exception, NotReplayable)
    assert words in refused.exception.detail


def test_a_run_of_which_nothing_was_compared_is_not_called_identical(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    store.close_run(start(store), RunResult.GOOD)
    monkeypatch.setattr(DeckToFrame, "replay", lambda *_: iter(()))
    refused = CliRunner().invoke(whole_app(), ["replay", "1", "--data-dir", str(store.path)])
    assert isinstance(refused.exception, NotReplayable)
    assert "no number that could be compared" in refused.exception.detail
    assert "identical" not in refused.output
