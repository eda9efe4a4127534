"""A study goes on where it was ended, mixes nothing, and survives its workers."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from benchmarks.study import __main__ as program
from benchmarks.study.chart import draw
from benchmarks.study.farm import farm
from benchmarks.study.farm_error import FarmError
from benchmarks.study.kinds import KINDS, run_seed
from benchmarks.study.outcome import StudyOutcome
from benchmarks.study.results import AnotherStudy, StudyResults, StudySource, source_digest
from benchmarks.study.table import end, tables, values_of
from cellctl.version import ROOT
from tests.rigs.mating.trial import Trial

SOURCE = StudySource("deck-loop", {}, "cellctl 0.1.0 (abc)", "00")


def outcome(seed: int, *, good: bool = True, fault: str = "") -> StudyOutcome:
    figures = {"true_peak_n": 30.0 + seed, "duration_s": float("nan")}
    return StudyOutcome(seed, good, good, fault, figures)


def test_results_are_there_again(tmp_path: Path) -> None:
    first = StudyResults(tmp_path, SOURCE)
    for seed in (3, 1):
        first.add(outcome(seed))
    again = StudyResults(tmp_path, SOURCE)
    assert [one.seed for one in again.outcomes] == [1, 3]
    assert again.has(3)
    assert not again.has(2)


def test_a_line_that_was_cut_runs_again(tmp_path: Path) -> None:
    StudyResults(tmp_path, SOURCE).add(outcome(1))
    file = tmp_path / "results.jsonl"
    whole = file.read_bytes()
    for kept in range(len(whole)):
        file.write_bytes(whole + whole[:kept].rstrip(b"\n"))
        again = StudyResults(tmp_path, SOURCE)
        assert [one.seed for one in again.outcomes] == [1]
        again.add(outcome(2))
        assert len(StudyResults(tmp_path, SOURCE).outcomes) == 2


@pytest.mark.parametrize(
    ("other", "word"),
    [
        (StudySource("deck-mating", {}, SOURCE.software, "00"), "kind deck-loop"),
        (StudySource("deck-loop", {"light": 2.0}, SOURCE.software, "00"), "scales"),
        (StudySource("deck-loop", {}, "cellctl 0.1.0 (def)", "00"), "software"),
        (StudySource("deck-loop", {}, SOURCE.software, "11"), "source 00, now 11"),
    ],
)
def test_two_studies_are_not_mixed(tmp_path: Path, other: StudySource, word: str) -> None:
    StudyResults(tmp_path, SOURCE)
    with pytest.raises(AnotherStudy, match=word):
        StudyResults(tmp_path, other)


def test_results_without_their_source_are_nobodys(tmp_path: Path) -> None:
    (tmp_path / "results.jsonl").touch()
    with pytest.raises(AnotherStudy, match=r"no study\.json"):
        StudyResults(tmp_path, SOURCE)


def test_the_digest_changes_with_a_file_and_with_a_name(tmp_path: Path) -> None:
    source = tmp_path / "cellctl" / "a.py"
    source.parent.mkdir()
    source.write_text("x = 1\n", encoding="utf-8")
    first = source_digest(tmp_path)
    source.write_text("x = 2\n", encoding="utf-8")
    second = source_digest(tmp_path)
    source.rename(source.with_name("b.py"))
    (source.parent / "c.pyc").touch()
    assert len({first, second, source_digest(tmp_path)}) == 3


def test_tables_and_picture(tmp_path: Path) -> None:
    kind = KINDS["deck-mating"]
    found = [outcome(seed) for seed in range(1, 40)]
    found.append(outcome(40, good=False, fault="F511 Contact too early: 1 mm"))
    found.append(StudyOutcome(41, good=False, called_good=True))
    ends, figures = tables(kind, found)
    assert [end(one) for one in found[-2:]] == ["F511 Contact too early", "CALLED GOOD, IS NOT"]
    assert ends.row_count == 3
    assert figures.row_count == 1, "a figure without any number has no line"
    assert len(values_of("true_peak_n", found)) == 40
    draw(kind, found, tmp_path / "study.png")
    assert (tmp_path / "study.png").stat().st_size > 10_000


def test_the_row_of_a_mating_has_the_figures_of_its_trial(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(drawn: Trial) -> Trial:
        return replace(drawn, outcome="F522", text="Contact too early", true_peak_n=37.0)

    monkeypatch.setattr("tests.rigs.mating.trial.run_trial", refused)
    row = run_seed("deck-mating", 1, {})
    assert (row["good"], row["fault"]) == (False, "F522 Contact too early")
    assert row["figures"]["true_peak_n"] == 37.0


@pytest.mark.figures
def test_a_trial_of_the_mating_is_plain_data() -> None:
    row = run_seed("deck-mating", 1, {})
    assert StudyOutcome.of(json.loads(json.dumps(row))).row() == row
    assert row["figures"]["true_peak_n"] > 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("another",), "there are: deck-loop, deck-mating"),
        (("peg-pin", "--imperfection", "light=2"), "scales no imperfection"),
        (("deck-mating", "-n", "1", "--scheduler", "nowhere://here"), "no scheduler at"),
    ],
)
def test_what_cannot_be_is_said(tmp_path: Path, words: tuple[str, ...], said: str) -> None:
    done = CliRunner().invoke(program.app, [*words, "--out", str(tmp_path)])
    assert done.exit_code == 1
    assert said in done.stderr


def test_a_scheduler_that_does_not_answer_is_waited_for_no_longer_than_said() -> None:
    with (
        pytest.raises(FarmError, match="no scheduler at"),
        farm("tcp://127.0.0.1:9", 1, connect_s=0.5),
    ):
        pass


def test_without_dask_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(sys.modules, "benchmarks.study.farm", raising=False)
    monkeypatch.setitem(sys.modules, "distributed", None)
    done = CliRunner().invoke(program.app, ["deck-mating", "--out", str(tmp_path)])
    assert done.exit_code == 1
    assert "pip install 'cellctl[study]'" in done.stderr


@pytest.mark.long  # its seeds are whole matings
@pytest.mark.timeout(600)
def test_ctrl_c_keeps_what_is_finished_and_the_next_start_goes_on(tmp_path: Path) -> None:
    words = ["-m", "cellctl", "study", "deck-mating", "--out", str(tmp_path), "--workers", "1"]
    lines = tmp_path / "results.jsonl"
    with subprocess.Popen(
        [sys.executable, *words, "-n", "400"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as study:
        end_s = time.monotonic() + 300
        while not (lines.exists() and lines.read_bytes().count(b"\n") >= 2):
            assert study.poll() is None
            assert time.monotonic() < end_s
            time.sleep(0.05)  # results come into a file, which nobody announces
        os.killpg(study.pid, signal.SIGINT)  # as a terminal does
        said, _ = study.communicate(timeout=120)
    assert study.returncode == program.INTERRUPTED, said
    kept = lines.read_text(encoding="utf-8").splitlines()
    assert f"{len(kept)} of 400 seeds are kept" in said
    done = subprocess.run(
        [sys.executable, *words, "-n", "3"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert f"{min(3, len(kept))} of 3 seeds are there" in done.stdout
