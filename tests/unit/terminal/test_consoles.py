"""What people and devices say is printed as it is: no brackets vanish, no names become pictures."""

import io
import re
from pathlib import Path

import pytest
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table

import cellctl
import drivers
from cellctl.errors.vision import ImageFileInvalid
from cellctl.terminal import consoles

FOLDERS = (Path(cellctl.__file__).parent, Path(drivers.__file__ or "").parent)
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


def test_a_long_line_goes_on_below_its_text() -> None:
    text = "  poses      contradict each other by less than 100 mm and 10 deg, as far as it goes"
    lines = consoles.hanging(text, 40, 13).splitlines()
    assert lines[0] == "  poses      contradict each other by"
    assert all(line.startswith(" " * 10) for line in lines[1:])
    assert all(len(line) <= 40 for line in lines)
    assert " ".join(text.split()) == " ".join(" ".join(lines).split())


def test_chinese_is_broken_by_the_width_that_it_has() -> None:
    lines = consoles.hanging("  原因：" + "在不应接触的地方发生接触，" * 5, 40, 8).splitlines()
    assert len(lines) > 2
    assert all(cell_len(line) <= 40 for line in lines)
    assert not any(line.strip().startswith("，") for line in lines)


def test_only_a_terminal_breaks_lines() -> None:
    for terminal in (True, False):
        file = io.StringIO()
        console = Console(file=file, force_terminal=terminal, width=40, soft_wrap=True)
        consoles.print_hanging(console, "word " * 20, 4)
        assert file.getvalue().count("\n") == (3 if terminal else 1)


def test_a_refusal_and_a_warning_are_as_wide_as_the_terminal(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = " ".join(["nothing in this picture is what the drawing has"] * 5)
    consoles.print_warning(words)
    assert capsys.readouterr().err == f"warning: {words}\n", "one line for a program"
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")
    consoles.print_refusal(ImageFileInvalid(words))
    consoles.print_warning(words)
    lines = capsys.readouterr().err.splitlines()
    assert max(len(line) for line in lines) <= 80
    assert len(lines) > 8
    assert [line for line in lines if line.startswith("     ")]


def test_no_command_prints_a_fault_past_the_width_of_the_terminal() -> None:
    written = [
        f"{path}: {line.strip()}"
        for folder in (FOLDERS[0] / "cli", FOLDERS[0] / "processes")
        for path in sorted(folder.rglob("*.py"))
        for line in path.read_text().splitlines()
        if re.search(r"\becho\(.*\{(fault|error)\b|\becho\(str\((fault|error)\)", line)
    ]
    assert written == []
