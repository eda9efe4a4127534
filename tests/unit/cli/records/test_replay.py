"""`cellctl replay`: what it refuses, with which words."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.errors.records import NotReplayable
from cellctl.records import RunResult, RunStore
from cellctl.records.entries import MAINTENANCE
from tests.unit.records.conftest import start


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


@pytest.mark.parametrize(
    ("process", "words"),
    [
        (MAINTENANCE, "run 1 is the procedure panel 500 x 1000, whose record keeps what it has"),
        ("antenna-module", "the process antenna-module cannot do that"),
        ("peg-in-hole", "the process peg-in-hole cannot do that"),
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
