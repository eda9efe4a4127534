"""What docs/cameras.md tells a stranger to do leads to images, word by word."""

import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import app_with
from cellctl.errors.base import CellError
from cellctl.errors.camera import CameraFeatureRefused

PAGE = (Path(__file__).parents[3] / "docs" / "cameras.md").read_text(encoding="utf-8")


def block(after: str) -> str:
    """The first indented block of the page after some words."""
    found = re.search(r"\n\n((?:    .*\n|\n)+)", PAGE[PAGE.index(after) :])
    assert found is not None
    return textwrap.dedent(found[1]).strip() + "\n"


def inline(opening: str) -> str:
    """The first words in backquotes that begin like this."""
    found = re.search(rf"`({re.escape(opening)}[^`]*)`", PAGE)
    assert found is not None
    return found[1]


def viky() -> str:
    """The path that the page's own command prints."""
    program = re.search(r'python -c "(.*)"', block("which this prints"))
    assert program is not None
    printed = subprocess.run(
        [sys.executable, "-c", program[1]], capture_output=True, text=True, check=True
    )
    return printed.stdout.strip()


@pytest.fixture
def bench(tmp_path: Path) -> Path:
    """`bench.toml` as the page has it, for the producer that comes with `genicam`."""
    text = block("`bench.toml`, with the piece")
    for key, value in (
        ("settings.producers", f'settings.producers = ["{viky()}"]'),
        ("settings.camera.serial_number", inline("settings.camera.serial_number = ")),
    ):
        text, times = re.subn(rf"{re.escape(key)} = .*", value, text)
        assert times == 1
    path = tmp_path / "bench.toml"
    path.write_text(text, encoding="utf-8")
    return path


def grab(bench: Path) -> None:
    ran(next(line for line in block("has one master").splitlines() if "grab" in line), bench)


def ran(written: str, bench: Path) -> None:
    """A command of the page, with the files of the test."""
    words = written.removeprefix("cellctl ").split()
    out = bench.parent / words[words.index("--out") + 1]
    words = [{"bench.toml": str(bench), out.name: str(out)}.get(word, word) for word in words]
    app = app_with("grab")
    assert app is not None
    result = CliRunner().invoke(app, words)
    if result.exception is not None:
        raise result.exception


def test_the_first_image_of_a_strange_producer(bench: Path) -> None:
    says = next(line.split("|")[1].strip() for line in PAGE.splitlines() if "no software" in line)
    with pytest.raises(CameraFeatureRefused, match=says):
        grab(bench)
    remedy = inline("settings.trigger = ")
    bench.write_text(bench.read_text(encoding="utf-8") + remedy + "\n", encoding="utf-8")
    grab(bench)
    assert sorted(path.name for path in (bench.parent / "images").iterdir()) == [
        "eye-000001.json",
        "eye-000001.png",
    ]


def test_two_cameras_without_trigger_as_a_head(bench: Path) -> None:
    """Refused without the time for which nothing moves, as "Heads without trigger" says."""
    text = bench.read_text(encoding="utf-8")
    text = text.replace("[cameras.eye]", "[stereo_cameras.head_1]")
    text = text.replace("settings.camera.serial_number", "settings.left.serial_number")
    text += f'settings.right.serial_number = "1"\n{inline("settings.trigger = ")}\n'
    bench.write_text(text, encoding="utf-8")
    command = "cellctl grab bench.toml --head head_1 --out images"
    assert f"`{command}`" in PAGE
    with pytest.raises(CellError, match="max_difference_s"):
        ran(command, bench)
    bench.write_text(f"{text}settings.max_difference_s = 30.0\n", encoding="utf-8")
    ran(command, bench)
    names = sorted(path.name for path in (bench.parent / "images").iterdir())
    assert names == [f"head_1-000001{end}" for end in ("-left.png", "-right.png", ".json")]


def test_the_unit_is_as_the_page_tries_it() -> None:
    unit = Path(__file__).parents[3] / "systemd" / "cellctl.service"
    families = re.search(r"RestrictAddressFamilies=(.*)", unit.read_text(encoding="utf-8"))
    assert families is not None
    assert f'-p RestrictAddressFamilies="{families[1]}"' in block("with the unit's limits")
