"""The files of a guide, as the package that it describes."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
_FILE = re.compile(
    r"^`(?P<path>[\w/.]+\.\w+)`\n```(?:python|toml|markdown)\n(?P<code>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)


def write_files(guide: Path, folder: Path) -> None:
    """Every file of a guide, in a folder of their own outside this repository."""
    for match in _FILE.finditer(guide.read_text(encoding="utf-8")):
        path = folder / match["path"]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(match["code"], encoding="utf-8")


def install(folder: Path, site: Path) -> None:
    """Install the package of a guide into ``site``, not into this environment."""
    offline = ["--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check"]
    done = run("pip", "install", "--quiet", *offline, "--target", str(site), str(folder))
    assert done.returncode == 0, done.stdout + done.stderr


def guide_package(guide: Path, name: str) -> tuple[Any, Any]:
    """The fixtures ``written`` and ``installed`` of a guide, one of each for all tests of a module.

    ``written`` is the folder, named after ``name`` and outside this repository, with every file of
    the guide; ``installed`` is where the package in it is installed, not in this environment.
    """

    @pytest.fixture(scope="module")
    def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
        folder = tmp_path_factory.mktemp(name)
        write_files(guide, folder)
        return folder

    @pytest.fixture(scope="module")
    def installed(written: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
        site = tmp_path_factory.mktemp("site")
        install(written, site)
        return site

    return written, installed


def contract_of(folder: Path, site: Path, only: str = "") -> "subprocess.CompletedProcess[str]":
    """The contract that a guide puts its package to, as ``make test`` would run it. ``only``:
    clauses with this in their names."""
    options = ["-c", str(folder / "pyproject.toml"), "-p", "no:cacheprovider", "-p", "no:xdist"]
    options += ["-k", only] if only else []
    return run("pytest", *options, "-q", "-W", "error", str(folder / "contract"), path=(ROOT, site))


def contract_by_hand(guide: Path, folder: Path, site: Path) -> "subprocess.CompletedProcess[str]":
    """The contract as the commands of a guide run it, with its package installed in ``site``."""
    text = guide.read_text(encoding="utf-8")
    (commands,) = re.findall(r"^cd (?:/\S+)\nPYTHONPATH=\S+ \S+ contract$", text, re.MULTILINE)
    name = re.search(r"/path/to/(cellctl-\w+)", commands)
    assert name is not None
    # Installed elsewhere than in this environment; the rest is as it is written.
    places = {
        name[0]: str(folder),
        "/path/to/the/checkout/.venv/bin/pytest": str(Path(sys.executable).parent / "pytest"),
        "PYTHONPATH=/path/to/the/checkout": f"PYTHONPATH={ROOT}:{site}",
    }
    for written, here in places.items():
        assert written in commands
        commands = commands.replace(written, here)
    return subprocess.run(
        ["bash", "-ec", commands], capture_output=True, text=True, timeout=180, check=False
    )


def registry_beside(site: Path) -> "subprocess.CompletedProcess[str]":
    """What this repository asks of every installed driver, with the package beside it."""
    options = ["-p", "no:cacheprovider", "-p", "no:xdist", "-v"]
    return run("pytest", *options, "tests/contracts/test_registry.py", path=(site,))


def style_of(folder: Path) -> "Iterator[subprocess.CompletedProcess[str]]":
    """Linter and formatter over the files of a guide."""
    files = [str(path) for path in folder.glob("**/*.py")]
    elsewhere = "D1,INP,I001"  # tests need no docstrings; order of imports depends on the tree
    yield run("ruff", "check", "--config", "pyproject.toml", "--ignore", elsewhere, *files)
    yield run("ruff", "format", "--check", "--config", "pyproject.toml", *files)


def run(*arguments: str, path: tuple[Path, ...] = ()) -> "subprocess.CompletedProcess[str]":
    """A module of this environment, with ``path`` before everything else."""
    return subprocess.run(
        [sys.executable, "-m", *arguments],
        cwd=ROOT,
        env=environment(*path),
        capture_output=True,
        text=True,
        timeout=180,
        check=False,
    )


def environment(*path: Path) -> dict[str, str]:
    """Environment of a program that finds packages in ``path`` first."""
    return os.environ | {"PYTHONPATH": os.pathsep.join(str(entry) for entry in path)}
