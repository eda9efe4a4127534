"""The campaign keeps what it has, goes on where it was, and uses a cell as long as it can."""

import io
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from rich.console import Console

from benchmarks.faults import campaign, daemon, table
from benchmarks.faults.bench import NotReached
from benchmarks.faults.campaign import Campaign, all_trials, chosen
from benchmarks.faults.kinds import Fault
from benchmarks.faults.observation import Observation
from benchmarks.faults.phases import Phase
from tests.unit.benchmarks.faults.seen import CALM

TRIALS = chosen(all_trials(), ["emergency-stop/contact", "link-cut/contact", "late/contact"], None)


class Cell:
    """Stands in for a bench: notes that it was opened and closed."""

    opened = 0
    closed = 0

    def __init__(self, folder: Path, seed: int) -> None:
        type(self).opened += 1
        self.fresh = True

    def close(self) -> None:
        type(self).closed += 1


class Played:
    """Stands in for a trial: says what comes next."""

    def __init__(self, *outcomes: object) -> None:
        self.outcomes = list(outcomes)

    def __call__(self, bench: Cell, fault: Fault, phase: Phase) -> Observation:
        outcome = self.outcomes.pop(0)
        bench.fresh = False
        if isinstance(outcome, BaseException):
            raise outcome
        assert isinstance(outcome, Observation)
        return replace(outcome, fault=fault.key, phase=phase.key)


@pytest.fixture(autouse=True)
def without_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    Cell.opened = Cell.closed = 0
    monkeypatch.setattr(campaign, "Bench", Cell)


def play(monkeypatch: pytest.MonkeyPatch, out: Path, *outcomes: object) -> Campaign:
    monkeypatch.setattr(campaign, "run_trial", Played(*outcomes))
    return Campaign(out, out / "matrix.json", 1, Console(file=io.StringIO()))


def test_one_cell_serves_as_long_as_it_comes_back_to_idle(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    work = play(monkeypatch, tmp_path, CALM, replace(CALM, idle_again=False), CALM)
    work.run(TRIALS)
    assert set(work.results) == {trial.key for trial in TRIALS}
    assert (Cell.opened, Cell.closed) == (2, 2)


def test_a_cell_whose_calibrations_are_void_serves_no_further_trial(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    void = replace(CALM, calibrated=False)
    play(monkeypatch, tmp_path, CALM, void, CALM).run(TRIALS)
    assert (Cell.opened, Cell.closed) == (2, 2)
    text = table.markdown({void.key: void})
    assert "calibrations to be made again" in text


def test_an_interrupted_campaign_goes_on_where_it_was(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with pytest.raises(KeyboardInterrupt):
        play(monkeypatch, tmp_path, CALM, KeyboardInterrupt()).run(TRIALS)
    assert Cell.closed == 1
    assert list(table.load(tmp_path / "matrix.json")) == [TRIALS[0].key]
    work = play(monkeypatch, tmp_path, CALM, CALM)
    work.run(TRIALS)
    assert len(table.load(tmp_path / "matrix.json")) == len(TRIALS)


def test_two_campaigns_work_towards_each_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    first = play(monkeypatch, tmp_path, CALM, KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):
        first.run(TRIALS)
    # It began when there was nothing in the file yet, and finds the first cell when it comes there.
    second = play(monkeypatch, tmp_path, CALM, CALM)
    second.results = {}
    second.run(TRIALS[::-1])
    assert set(table.load(tmp_path / "matrix.json")) == {trial.key for trial in TRIALS}


def test_a_phase_that_is_not_reached_is_tried_again_in_another_cell(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    work = play(monkeypatch, tmp_path, NotReached("late"), CALM, *[NotReached("never")] * 2)
    work.run(TRIALS[:2])
    assert list(work.results) == [TRIALS[0].key]
    assert work.not_reached == {TRIALS[1].key: "never"}
    assert Cell.opened == Cell.closed == 3


def test_heads_move_in_a_fresh_cell_only(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fresh = chosen(all_trials(), ["link-cut/starting"], None)
    play(monkeypatch, tmp_path, CALM, CALM).run([TRIALS[0], *fresh])
    assert Cell.opened == Cell.closed == 2
    Cell.opened = 0
    play(monkeypatch, tmp_path / "other", CALM, CALM).run([*fresh, TRIALS[0]])
    assert Cell.opened == 1


def test_the_clock_of_the_daemon_can_be_set_back(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    file = tmp_path / "offset"
    monkeypatch.setenv(daemon.CLOCK_FILE, str(file))
    second = timedelta(seconds=1)
    assert abs(daemon.shifted_utc_now() - datetime.now(UTC)) < second
    file.write_text("-86400.0", encoding="ascii")
    assert abs(daemon.shifted_utc_now() + timedelta(days=1) - datetime.now(UTC)) < second
