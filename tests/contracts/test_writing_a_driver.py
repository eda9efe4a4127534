"""docs/writing-a-driver.md is true: its files are written out, checked and put to the contract."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GUIDE = ROOT / "docs" / "writing-a-driver.md"
FILE = re.compile(
    r"^`(?P<path>[\w/]+\.py)`\n```python\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL
)

GRAFT = '''
"""Lets the packages of the guide be found inside the real ones."""

from pathlib import Path

import drivers.camera
import fakes.wire

HERE = Path(__file__).parent
drivers.camera.__path__.append(str(HERE / "drivers" / "camera"))
fakes.wire.__path__.append(str(HERE / "fakes" / "wire"))
'''


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All files of the guide in a folder of their own."""
    folder = tmp_path_factory.mktemp("guide")
    for match in FILE.finditer(GUIDE.read_text()):
        path = folder / match["path"]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(match["code"])
    (folder / "drivers/camera/acme/__init__.py").touch()
    (folder / "conftest.py").write_text(GRAFT)
    return folder


def run(*arguments: str) -> "subprocess.CompletedProcess[str]":
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(
        [sys.executable, "-m", *arguments],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def test_the_folder_is_complete(written: Path) -> None:
    files = {path.name for path in (written / "drivers/camera/acme").iterdir()}
    assert {"config.py", "protocol.py", "connection.py", "driver.py", "faults.py"} <= files


def test_the_contract_holds(written: Path) -> None:
    test = str(written / "tests/contracts/test_acme.py")
    options = ["--import-mode=importlib", "-p", "no:cacheprovider", "-p", "no:xdist", "-q"]
    done = run("pytest", "-c", "pyproject.toml", f"--confcutdir={written}", *options, test)
    assert done.returncode == 0, done.stdout + done.stderr
    assert " passed" in done.stdout


def test_the_code_has_the_style_of_the_house(written: Path) -> None:
    files = [str(path) for path in written.glob("[dft]*/**/*.py") if path.name != "__init__.py"]
    elsewhere = "D1,INP,I001"  # tests need no docstrings; order of imports depends on the tree
    done = run("ruff", "check", "--config", "pyproject.toml", "--ignore", elsewhere, *files)
    assert done.returncode == 0, done.stdout + done.stderr
    done = run("ruff", "format", "--check", "--config", "pyproject.toml", *files)
    assert done.returncode == 0, done.stdout + done.stderr


def test_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", GUIDE.read_text()):
        assert (GUIDE.parent / target).exists(), target
