"""`cellctl runs trend`: which runs count, and what is printed."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from cellctl.cli.records.runs import app
from cellctl.records import RunResult, RunStore
from cellctl.records.figures import Limit, figure
from tests.unit.records.conftest import start

KEY = "seat.gap"
RUNNER = CliRunner(env={"COLUMNS": "160", "NO_COLOR": "1"})


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


def made(store: RunStore, *values: float | None, close: bool = True) -> int:
    """A run that found these values, one after the other."""
    run = start(store)
    for value in values:
        store.add(run, figure(KEY, value, "mm", limit=Limit(-0.1, 0.1)))
    if close:
        store.close_run(run, RunResult.GOOD)
    return run


def asked(store: RunStore, *words: str) -> Result:
    return RUNNER.invoke(app, ["trend", *words, "--data-dir", str(store.path)])


def test_the_last_known_value_of_each_finished_run_counts(store: RunStore) -> None:
    first = made(store, 0.5, 0.01)
    second = made(store, 0.02, None)
    made(store, 0.03, close=False)
    # What was cut off says nothing of the process that comes to its end.
    for cut in (RunResult.ABORTED, RunResult.STOPPED):
        store.close_run(made(store, 0.04, close=False), cut)
    found = json.loads(asked(store, KEY, "--json").stdout)
    assert [(one["run"], one["value"]) for one in found["samples"]] == [
        (first, 0.01),
        (second, 0.02),
    ]
    assert found["unit"] == "mm"


def test_limits_capability_and_what_has_changed_are_shown(store: RunStore) -> None:
    for value in (0.01, 0.02, 0.01, 0.02, 0.01, 0.02, 0.01, 0.02, 0.01, 0.02, 0.15):
        made(store, value)
    done = asked(store, KEY)
    assert done.exit_code == 0, done.output
    assert "-0.1 … 0.1" in done.stdout
    assert "Cpk" in done.stdout
    assert "95% between" in done.stdout
    assert "run 11:" in done.stdout
    assert "sigma from the mean" in done.stdout


def test_keys_are_listed_and_what_is_unknown_is_said(store: RunStore) -> None:
    made(store, 0.01)
    assert asked(store).stdout.splitlines()[-1] == KEY
    done = asked(store, "no.such")
    assert done.exit_code == 1
    assert "no.such" in done.stderr
    assert asked(store, KEY, "--recipe", "77").exit_code == 1


def test_an_unknown_figure_is_answered_with_the_nearest(store: RunStore) -> None:
    made(store, 0.01)
    done = asked(store, "seat.gaps")
    assert done.exit_code == 1
    assert f"no run has a figure 'seat.gaps'; did you mean '{KEY}'? " in done.output
    assert "1 runs have the figure" in asked(store, KEY).output


def test_keys_are_there_for_programs_and_none_is_said(store: RunStore) -> None:
    assert "no run of this store has any yet" in asked(store).stdout
    assert json.loads(asked(store, "--json").stdout) == []
    made(store, 0.01)
    assert KEY in json.loads(asked(store, "--json").stdout)
