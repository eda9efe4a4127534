"""How a demonstration ended: the cell's own result beside the truth of the fake world."""

import json
import shutil
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.table import Table

from fakes.demo.children import ChildFailed
from fakes.demo.demo import Demo, Evidence, Judgement


@dataclass(frozen=True, slots=True)
class Outcome:
    """A run that is over, judged."""

    seed: int
    result: str
    judgement: Judgement
    wall_s: float
    lost_s: float
    """Time that the PC could not give to the fake world, which ran slower by as much."""
    report: str
    """Path of the HTML report; empty when no run was opened."""


def collect(
    demo: Demo, folder: Path, line: dict[str, Any], truth: dict[str, Any], wall_s: float
) -> Outcome:
    """Enter what the measuring room finds, export record and report, judge them by the truth.

    Writes ``truth.json``, ``result.json`` and the folder ``report``.
    """
    _write(folder / "truth.json", truth)
    evidence = Evidence(line, truth, {})
    run = int(line.get("run") or 0)
    if run:
        for arguments in demo.measure(evidence):
            _cellctl(folder, "runs", *arguments)
        # The report may be that of an earlier demonstration, whose run stays in the store.
        shutil.rmtree(folder / "report", ignore_errors=True)
        _cellctl(folder, "runs", "export", str(run), "--out", str(folder / "report"))
        record = json.loads((folder / "report" / "run.json").read_text(encoding="utf-8"))
        text = (folder / "report" / "recipe.json").read_text(encoding="utf-8")
        evidence = replace(evidence, record=record, recipe=json.loads(text)["recipe"])
    judgement = demo.judge(evidence)
    outcome = Outcome(
        seed=truth["seed"],
        result=str(line.get("result")),
        judgement=judgement,
        wall_s=wall_s,
        lost_s=truth["lost_s"],
        report=str(folder / "report" / "report.html") if run else "",
    )
    _write(
        folder / "result.json",
        {
            "process": demo.process,
            "seed": outcome.seed,
            "passed": judgement.passed,
            "result": line.get("result"),
            "fault": evidence.record.get("fault") or line.get("message") or "",
            **judgement.figures,
            "wall_s": wall_s,
            "lost_s": outcome.lost_s,
            "report": outcome.report,
        },
    )
    return outcome


def result_table(outcome: Outcome) -> Table:
    """The table that is shown at the end of the demonstration."""
    table = Table("figure", "value", "limit", title=f"seed {outcome.seed}: {outcome.result}")
    for row in outcome.judgement.rows:
        written = "–" if row.value is None else row.form.format(row.value)
        table.add_row(row.name, written, row.limit, style="red" if row.within is False else None)
    table.add_row("wall time, s", f"{outcome.wall_s:.0f}", "")
    table.add_row("lost by the fake cell on a busy PC, s", f"{outcome.lost_s:.2f}", "")
    return table


def _write(path: Path, values: dict[str, Any]) -> None:
    path.write_text(json.dumps(values, indent=2) + "\n", encoding="utf-8")


def _cellctl(folder: Path, *arguments: str) -> None:
    to_store = "--data-dir", str(folder / "store")
    command = [sys.executable, "-P", "-m", "cellctl", *arguments, *to_store]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode:
        raise ChildFailed(f"cellctl {' '.join(arguments)}:\n{done.stderr.strip()}")
