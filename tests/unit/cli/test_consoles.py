"""What people and devices say is printed as it is: no brackets vanish, no names become pictures."""

import re
from pathlib import Path

import pytest
from rich.table import Table

import cellctl.cli
import drivers
from cellctl.cli import consoles

FOLDERS = (Path(cellctl.cli.__file__).parent, Path(drivers.__file__ or "").parent)
SAID = "SAT [x] :100: [/]"


def test_a_line_and_a_table_show_brackets(capsys: pytest.CaptureFixture[str]) -> None:
    consoles.console_of_lines().print(SAID)
    table = Table(SAID, box=None)
    table.add_row(SAID)
    consoles.console_of_tables().print(table)
    assert capsys.readouterr().out.count(SAID) == 3


def test_no_command_makes_a_console_that_reads_mark_up() -> None:
    """Nobody thinks of brackets in a serial number where one is made in passing."""
    made = [
        f"{path}: {line.strip()}"
        for folder in FOLDERS
        for path in sorted(folder.rglob("*.py"))
        for line in path.read_text().splitlines()
        if re.search(r"\bConsole\(", line) and "markup=False" not in line
    ]
    assert made == []
