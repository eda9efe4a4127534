"""The help lists every command, and what computes nothing loads nothing that computes."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer

from cellctl.cli import commands
from cellctl.cli.listing import CELL, FILES, Listed

ROOT = Path(__file__).parents[3]


def test_every_command_is_listed_once_and_no_other() -> None:
    assert sorted(listed.name for listed in (*CELL, *FILES)) == sorted(commands._ADD)


@pytest.mark.parametrize("listed", [*CELL, *FILES], ids=lambda one: one.name)
def test_a_command_stands_in_its_own_panel_with_its_own_words(listed: Listed) -> None:
    group: Any = typer.main.get_command(commands.whole_app())
    name, panel, summary = next(row for row in group.rows(None) if row[0] == listed.name)
    command = group.get_command(None, name)
    assert command.rich_help_panel == panel
    # The beginning is that of the command's own help, so that a change of one is a change of both.
    assert command.help is not None
    assert command.help.split()[:3] == summary.split()[:3]


@pytest.mark.parametrize(
    "words",
    ["--help", "status", "faults", "faults 207", "runs list --data-dir absent", "runs --help"],
)
def test_a_command_that_computes_nothing_loads_nothing_that_computes(words: str) -> None:
    program = (
        "import sys\n"
        f"sys.argv = ['cellctl', *{words.split()!r}]\n"
        "from cellctl.cli.app import main\n"
        "try:\n"
        "    main()\n"
        "finally:\n"
        "    heavy = {'numpy', 'scipy', 'matplotlib', 'cv2', 'pandas'} & set(sys.modules)\n"
        "    print('heavy:', sorted(heavy), file=sys.stderr)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert "heavy: []" in done.stderr, done.stderr


@pytest.mark.parametrize("name", ["deck", "antenna", "insertion-pin", "small"])
def test_checking_a_cell_file_loads_neither_pictures_nor_the_database(name: str) -> None:
    program = (
        "import sys\n"
        f"sys.argv = ['cellctl', 'check', 'config/{name}.toml']\n"
        "from cellctl.cli.app import main\n"
        "try:\n"
        "    main()\n"
        "finally:\n"
        "    heavy = {'matplotlib', 'cv2', 'sqlalchemy', 'pandas'} & set(sys.modules)\n"
        "    print('heavy:', sorted(heavy), file=sys.stderr)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert "good." in done.stdout, done.stdout
    assert "heavy: []" in done.stderr, done.stderr
