"""`cellctl judge-insertion`: the verdict of a recorded insertion, by the process it belongs to.

Exit codes: 0 inserted; 3 judged and not inserted, or unknown; 1 for a fault of the files, which is
named with its number.
"""

import json
from pathlib import Path
from typing import Annotated, cast

import typer

from cellctl import plugins
from cellctl.calibration.judged_insertion import InsertionJudge, JudgedInsertion
from cellctl.calibration.output_file import write_file
from cellctl.cli.offline.calibration_output import print_checks
from cellctl.terminal.consoles import console_of_lines, print_hanging

NOT_GOOD = 3
BY_CONNECTOR, BY_TASK = "connector", "task"
"""Names of the judges, which are those of their options."""


def judge_insertion(
    curve: Annotated[Path, typer.Option(help="Recorded curve: CSV, or MCAP where it is a task.")],
    connector: Annotated[
        Path | None,
        typer.Option(help="A plug by two cameras: its drawing, TOML (docs/plugging.md)."),
    ] = None,
    task: Annotated[
        Path | None,
        typer.Option(
            help="A peg by touch: its task, TOML, or run.json of an exported run "
            "(docs/insertion-by-touch.md)."
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write the result to this JSON file.")] = None,
) -> None:
    """Whether a part is inserted, by its recorded curve: every figure with its limit.

    Give --connector or --task, whichever says what was inserted.
    """
    judged = _judged(curve, connector, task)
    console = console_of_lines()
    print_checks(console, judged.checks)
    for sentence in judged.said:
        print_hanging(console, f"  {sentence}", 2)
    console.print(judged.verdict)
    if judged.fault is not None:
        print_hanging(console, str(judged.fault), 5)
    if out is not None:
        text = json.dumps(judged.record, indent=2, allow_nan=False) + "\n"
        write_file(out, text.encode())
    if not judged.good:
        raise typer.Exit(NOT_GOOD)


def _judged(curve: Path, connector: Path | None, task: Path | None) -> JudgedInsertion:
    given = {
        name: file
        for name, file in ((BY_CONNECTOR, connector), (BY_TASK, task))
        if file is not None
    }
    if len(given) != 1:
        raise typer.BadParameter("give either --connector or --task: what was inserted")
    ((name, file),) = given.items()
    judge = cast(InsertionJudge, plugins.load_function(plugins.INSERTION_JUDGE, name))
    return judge(curve, file)
