"""The help lists every command, and what computes nothing loads nothing that computes."""

import json
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from cellctl.cli import commands
from cellctl.cli.help.listing import BROUGHT, CELL, FILES, OPERATOR, Listed
from cellctl.cli.operator import commands as operator_commands
from cellctl.records import RunStore
from cellctl.version import software
from tests.rigs.sweeps import sweep
from tests.unit.records.sample import good_run

ROOT = Path(__file__).parents[4]


def test_every_command_is_listed_once_and_no_other() -> None:
    assert sorted(listed.name for listed in (*CELL, *FILES)) == sorted(commands._ADD)
    alone: Any = typer.main.get_command(operator_commands.app)
    names = alone.list_commands(None)
    assert [listed.name for listed in OPERATOR] == names


def test_what_comes_with_cellctl_is_told_in_words() -> None:
    told = CliRunner().invoke(commands.whole_app(), ["--help"]).output
    assert "says what it does" not in told
    assert {one.name for one in BROUGHT} <= set(told.split())


@pytest.mark.parametrize("listed", [*CELL, *OPERATOR, *FILES, *BROUGHT], ids=lambda one: one.name)
def test_a_command_stands_in_its_own_panel_with_its_own_words(listed: Listed) -> None:
    group: Any = typer.main.get_command(commands.whole_app())
    name, panel, summary = next(row for row in group.rows(None) if row[0] == listed.name)
    command = group.get_command(None, name)
    assert command.rich_help_panel == panel
    # The beginning is that of the command's own help, so that a change of one is a change of both.
    assert command.help is not None
    assert command.help.split()[:3] == summary.split()[:3]


HEAVY = ("numpy", "scipy", "matplotlib", "cv2", "pandas", "sqlalchemy")


def loaded_by(*commands: str, heavy: Sequence[str] = HEAVY) -> tuple[str, str]:
    """Output of commands, one after the other, and what of the heavy packages they have loaded."""
    program = (
        "import sys\n"
        "from contextlib import suppress\n"
        "from cellctl.cli.app import main\n"
        "try:\n"
        f"    for words in {[words.split() for words in commands]!r}:\n"
        "        sys.argv = ['cellctl', *words]\n"
        "        with suppress(SystemExit):\n"
        "            main()\n"
        "finally:\n"
        f"    heavy = set({tuple(heavy)!r}) & set(sys.modules)\n"
        "    print('heavy:', *sorted(heavy), file=sys.stderr)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    (found,) = re.findall("^heavy:(.*)$", done.stderr, re.MULTILINE)
    return done.stdout, found.strip()


MESSAGES = ("cellctl.api.local_socket.messages",)
"""Of the daemon; whoever does not ask it need not wait until they are loaded."""


@pytest.mark.parametrize(
    ("commands", "besides"),
    [
        (("--help", "faults 207", "runs list --data-dir absent"), MESSAGES),
        (("status", "faults", "runs --help"), ()),
    ],
)
def test_commands_that_compute_nothing_load_nothing_that_computes(
    commands: tuple[str, ...], besides: tuple[str, ...]
) -> None:
    assert loaded_by(*commands, heavy=HEAVY + besides)[1] == ""


def test_runs_are_listed_without_the_database_layer(tmp_path: Path) -> None:
    store = RunStore(tmp_path)
    good_run(store)
    store.close()
    out, heavy = loaded_by(f"runs list --json --data-dir {tmp_path}")
    assert [run["serial"] for run in json.loads(out)] == ["SAT-0042"]
    assert heavy == ""


FINDS_ROOTS = ("scipy.optimize", "scipy.signal", "scipy.stats")
"""Only for matings and views of a board: these are spread by a low-discrepancy sequence of SciPy's
statistics."""


@pytest.mark.parametrize(
    ("name", "besides"),
    sweep(
        (("deck", ()), ("antenna", ()), ("insertion-pin", FINDS_ROOTS), ("small", FINDS_ROOTS)),
        (("insertion-pin", FINDS_ROOTS),),
    ),
)
def test_checking_a_cell_file_loads_neither_pictures_nor_the_database(
    name: str, besides: tuple[str, ...]
) -> None:
    heavy = ("matplotlib", "cv2", "sqlalchemy", "pandas", *besides)
    out, found = loaded_by(f"check config/{name}.toml", heavy=heavy)
    assert "good." in out
    assert found == ""


def test_the_version_is_told_with_its_revision() -> None:
    told = CliRunner().invoke(commands.whole_app(), ["--version"])
    assert told.exit_code == 0
    assert told.output.strip() == software()
