"""The files of a guide, as the package that it describes."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
_FILE = re.compile(
    r"^`(?P<path>[\w/]+\.\w+)`\n```(?:python|toml|markdown)\n(?P<code>.*?)^```$",
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
    """Of a program that finds packages in ``path`` first."""
    return os.environ | {
        "PYTHONPATH": os.pathsep.join(str(entry) for entry in path),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
