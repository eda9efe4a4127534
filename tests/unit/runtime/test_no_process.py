"""The core alone: it imports, checks a cell file, and its unit idles with no process installed."""

import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl import plugins
from cellctl.cli.commands import whole_app
from cellctl.config import load_cell, problems
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from tests.unit.cell.bench import CELL_FILE, make_bench
from tests.unit.daemon_rig import DaemonRig

IMPORT_EVERYTHING = """
import importlib, pkgutil, sys

class NoProcesses:
    def find_spec(self, name, path=None, target=None):
        if name.startswith("cellctl.processes."):
            raise ImportError(f"{name} is not installed")

sys.meta_path.insert(0, NoProcesses())
import cellctl
count = 0
for module in pkgutil.walk_packages(cellctl.__path__, "cellctl."):
    if module.name.startswith("cellctl.processes") or module.name == "cellctl.__main__":
        continue
    importlib.import_module(module.name)
    count += 1
print(count)
"""


@pytest.fixture
def nothing_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the entry points of all processes disappear; drivers stay."""
    everything = plugins.installed

    def without_processes(group: str) -> tuple[EntryPoint, ...]:
        return () if group == plugins.PROCESS else everything(group)

    monkeypatch.setattr(plugins, "installed", without_processes)


def bare_cell_file(folder: Path) -> Path:
    """The fake cell's devices without any recipe."""
    text = CELL_FILE.read_text()
    text = text[: text.index("[processes.deck-to-frame]")]
    path = folder / "cell.toml"
    path.write_text(text)
    return path


@pytest.mark.figures  # imports all; `make imports` reads the same from the sources
def test_every_module_of_the_core_imports_without_a_process() -> None:
    run = subprocess.run(
        [sys.executable, "-c", IMPORT_EVERYTHING],
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert run.returncode == 0, run.stderr
    assert int(run.stdout) > 200


@pytest.mark.usefixtures("nothing_installed")
def test_a_cell_without_recipes_is_good(tmp_path: Path) -> None:
    path = bare_cell_file(tmp_path)
    assert problems(path) == []
    result = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert result.exit_code == 0
    assert "  recipe " not in result.output


@pytest.mark.usefixtures("nothing_installed")
def test_a_recipe_of_a_process_that_is_not_installed_is_named() -> None:
    found = {problem.key: problem for problem in problems(CELL_FILE)}
    assert found["recipes.0.process"].number == 103
    assert "none" in found["recipes.0.process"].allowed


async def test_the_unit_idles_and_refuses_what_it_cannot_make(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    bench = make_bench(tmp_path)
    request.getfixturevalue("nothing_installed")
    bench.cell.config = load_cell(bare_cell_file(tmp_path))
    rig = DaemonRig(bench, tmp_path / "store", monkeypatch)
    await rig.open()
    try:
        await rig.idle()
        assert await rig.take(Command.START) is RejectCode.RECIPE_UNKNOWN
        assert (
            await rig.take(Command.START, unit_mode=2, recipe_id=101) is RejectCode.RECIPE_UNKNOWN
        )
        assert rig.unit.machine.state is State.IDLE
        assert not rig.shown().ready
    finally:
        await rig.close()
