"""The sample files: every command of docs/samples.md gives what the page says."""

import json
import re
import shlex
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import isclose
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from benchmarks.samples import images, plugging, poses
from cellctl.cli.commands import whole_app
from cellctl.cli.help.help_groups import OFFLINE

ROOT = Path(__file__).parents[4]
SAMPLES = ROOT / "config" / "samples"
PAGE = ROOT / "docs" / "samples.md"
_COMMAND = re.compile(r"^    cellctl (.+)$", re.MULTILINE)
_BLOCK = re.compile(r"^```(text|json)\n(.*?)^```", re.MULTILINE | re.DOTALL)
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


@dataclass
class Example:
    """A command of the page with what follows it."""

    words: list[str]
    exit_code: int
    prints: list[str] = field(default_factory=list)
    writes: dict[str, Any] = field(default_factory=dict)


def examples() -> Iterator[Example]:
    before, *parts = _COMMAND.split(PAGE.read_text(encoding="utf-8"))
    for command, after in zip(parts[::2], parts[1::2], strict=True):
        # What is said of the exit code stands between the heading or block above and the command.
        code = re.search(r"exit code (\d)", re.split(r"^#.*|^```", before, flags=re.M)[-1], re.I)
        example = Example(shlex.split(command), int(code[1]) if code else 0)
        for kind, text in _BLOCK.findall(after):
            if kind == "text":
                example.prints += text.splitlines()
            else:
                example.writes = json.loads(text)
        yield example
        before = after


def test_every_command_prints_and_writes_what_the_page_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One after the other in one folder: some read what others have written."""
    shutil.copytree(SAMPLES, tmp_path / "samples")
    monkeypatch.chdir(tmp_path / "samples")
    tried = list(examples())
    for example in tried:
        done = CliRunner(env={"COLUMNS": "160"}).invoke(whole_app(), example.words)
        text = f"{done.output}\n{done.exception or ''}"
        assert done.exit_code == example.exit_code, (example.words, text)
        assert example.prints or example.writes, example.words
        for line in example.prints:
            assert any(alike(line, printed) for printed in text.splitlines()), (line, text)
        if example.writes:
            out = Path(example.words[example.words.index("--out") + 1])
            contains(json.loads(out.read_text(encoding="utf-8")), example.writes)
    assert len(tried) >= 14


def alike(expected: str, printed: str) -> bool:
    """The same words; numbers as near as two computers' rounding, and the page's own, allow."""
    if _NUMBER.sub("#", expected).strip() not in _NUMBER.sub("#", printed):
        return False
    numbers = zip(_NUMBER.findall(expected), _NUMBER.findall(printed), strict=False)
    return all(isclose(float(a), float(b), rel_tol=0.02, abs_tol=0.002) for a, b in numbers)


def contains(found: Any, expected: Any) -> None:
    if isinstance(expected, dict):
        for key, value in expected.items():
            contains(found[key], value)
    elif isinstance(expected, list):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            contains(one, other)
    elif isinstance(expected, float):
        assert found == pytest.approx(expected, rel=1e-3)
    else:
        assert found == expected


def test_every_offline_command_has_a_sample() -> None:
    commands: Any = typer.main.get_command(whole_app())
    context: Any = None
    # Each calibration has a sample of its own; plans are made of cell files, and a study draws its
    # own seeds.
    offline = {
        name
        for name, panel, _ in commands.rows(context)
        if panel == OFFLINE and name not in {"calibrate", "plan", "study"}
    }
    calibrate = commands.get_command(context, "calibrate")
    calibrations = set(calibrate.commands) - {"invalidate", "seal"}
    shown = [example.words for example in examples()]
    assert {words[0] for words in shown} >= offline
    assert {words[1] for words in shown if words[0] == "calibrate"} == calibrations


def test_the_script_makes_the_files_that_are_shipped(tmp_path: Path) -> None:
    poses.write_hand_eye(tmp_path / "hand-eye.json")
    poses.write_base_frame(tmp_path / "base-frame.json")
    poses.write_transfer(tmp_path / "transfer.json")
    poses.write_tool(tmp_path / "tool.json")
    poses.write_payload(tmp_path / "payload.csv")
    plugging.write_plugging(tmp_path / "plugging")
    images.write_plate(tmp_path / "plate")
    made = [path for path in tmp_path.rglob("*") if path.is_file()]
    for path in made:
        shipped = (SAMPLES / path.relative_to(tmp_path)).read_bytes()
        # An image is drawn with floating-point numbers, whose last digits are the computer's own.
        if path.suffix != ".png":
            assert path.read_bytes() == shipped, path.name
    assert len(made) >= 12


def test_all_samples_together_are_small() -> None:
    assert sum(path.stat().st_size for path in SAMPLES.rglob("*") if path.is_file()) < 2_000_000
