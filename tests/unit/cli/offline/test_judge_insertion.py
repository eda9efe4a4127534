"""`cellctl judge-insertion` of a peg by touch: exit codes, and one judge at a time."""

import json
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from cellctl.cli.offline.judge_insertion import judge_insertion
from cellctl.processes.peg_in_hole.faults import PegCurveInvalid
from tests.rigs.insertion.curves import TASK, Inserted, as_csv, inserted


def run(*words: str) -> Any:
    app = typer.Typer()
    app.command()(judge_insertion)
    return CliRunner().invoke(app, words)


def files(folder: Path, made: Inserted) -> tuple[str, ...]:
    rows, kinds = inserted(made)
    (folder / "c.csv").write_bytes(as_csv(rows, kinds))
    (folder / "task.toml").write_text(TASK)
    return "--curve", str(folder / "c.csv"), "--task", str(folder / "task.toml")


@pytest.mark.parametrize(
    ("made", "code", "verdict"),
    [
        (Inserted(), 0, "inserted"),
        (Inserted(walls=()), 3, "not inserted"),
        (Inserted(pushed=()), 3, "unknown"),
    ],
)
def test_the_exit_code_lets_only_an_inserted_part_pass(
    tmp_path: Path, made: Inserted, code: int, verdict: str
) -> None:
    out = tmp_path / "verdict.json"
    result = run(*files(tmp_path, made), "--out", str(out))
    assert result.exit_code == code, result.exception
    assert f"\n{verdict}\n" in result.output
    assert json.loads(out.read_text())["judgement"]["verdict"] == verdict


def test_a_curve_that_cannot_be_read_is_a_numbered_fault(tmp_path: Path) -> None:
    words = files(tmp_path, Inserted())
    (tmp_path / "c.csv").write_text("time_s,x_mm\n")
    result = run(*words)
    assert isinstance(result.exception, PegCurveInvalid)


def test_what_was_inserted_is_said_once(tmp_path: Path) -> None:
    words = files(tmp_path, Inserted())
    assert run(*words[:2]).exit_code == 2
    assert run(*words, "--connector", words[3]).exit_code == 2


@pytest.mark.parametrize(("least_mm", "said"), [(-1.0, False), (-0.4, True)])
def test_what_a_curve_leaves_open_is_said_before_the_verdict(
    tmp_path: Path, least_mm: float, said: bool
) -> None:
    head, *lines = Path("config/samples/plugging/seated.csv").read_text().splitlines()
    kept = [line for line in lines if float(line.split(",")[1]) >= least_mm]
    (tmp_path / "c.csv").write_text("\n".join([head, *kept]))
    drawing = "config/samples/plugging/micro-d-15-holes.toml"
    out = tmp_path / "verdict.json"
    result = run(
        "--curve", str(tmp_path / "c.csv"), "--connector", drawing, "--out", str(out)
    )  # fmt: skip
    assert result.exit_code == 0
    assert ("So nothing shows that" in result.output) is said
    assert bool(json.loads(out.read_text())["left_open"]) is said
