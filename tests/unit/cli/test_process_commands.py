"""Offline commands that a process brings by the entry point ``cellctl.command``."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from cellctl import plugins
from cellctl.cli.commands import app_with, whole_app
from cellctl.errors.config import UnknownDriver

MODULE = '''
import typer


def add(app: typer.Typer) -> None:
    app.command("weigh-picture", rich_help_panel="From files, without a cell")(weigh_picture)


def weigh_picture(kilograms: float) -> None:
    """Weigh a picture."""
    typer.echo(f"{kilograms} kg")


def other(app: typer.Typer) -> None:
    raise AssertionError("a core command was replaced")
'''
POINTS = """[cellctl.command]
weigh-picture = acme_pictures:add
broken-picture = acme_nowhere:add
absent-picture = acme_pictures:nothing
check = acme_pictures:other
"""


@pytest.fixture(autouse=True)
def acme(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An installed package with four commands, of which one is usable."""
    (tmp_path / "acme_pictures.py").write_text(MODULE)
    info = tmp_path / "acme_pictures-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: acme-pictures\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(POINTS)
    monkeypatch.syspath_prepend(str(tmp_path))
    plugins.every.cache_clear()
    yield
    sys.modules.pop("acme_pictures", None)
    plugins.every.cache_clear()


def invoke(app: Any, *words: str) -> Any:
    return CliRunner().invoke(app, words)


def test_a_command_of_a_process_is_offered_and_runs() -> None:
    app = app_with("weigh-picture")
    assert app is not None
    # Typer leaves the name out of a command line that has one command alone, unless its root has
    # options, as ours has.
    assert invoke(app, "weigh-picture", "2.5").output == "2.5 kg\n"
    assert invoke(whole_app(), "weigh-picture", "2.5").stdout == "2.5 kg\n"


def test_the_help_lists_it_without_loading_its_package() -> None:
    text = invoke(whole_app(), "--help").stdout
    panel = text[text.index("From installed packages") :]
    assert "weigh-picture" in panel
    assert "acme_pictures" not in sys.modules
    assert "Weigh a picture." in invoke(whole_app(), "weigh-picture", "--help").stdout


@pytest.mark.parametrize("name", ["broken-picture", "absent-picture"])
def test_a_command_that_cannot_be_loaded_is_a_fault_for_who_asks_for_it(name: str) -> None:
    with pytest.raises(UnknownDriver, match=name):
        app_with(name)


def test_the_help_survives_a_command_that_cannot_be_loaded() -> None:
    done = invoke(whole_app(), "--help")
    assert done.exit_code == 0
    assert "broken-picture" in done.stdout


def test_a_process_does_not_replace_a_command_of_the_core() -> None:
    assert app_with("check") is not None
    assert invoke(whole_app(), "--help").stdout.count("  check ") == 1


def test_an_unknown_name_is_no_command() -> None:
    assert app_with("weigh-nothing") is None
