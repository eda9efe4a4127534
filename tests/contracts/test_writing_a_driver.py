"""docs/writing-a-driver.md is true: its files are written out, installed as the package that they
describe, and put to the contract; and this repository's own tests still pass beside it.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.guides.package import (
    ROOT,
    contract_by_hand,
    contract_of,
    guide_package,
    registry_beside,
    style_of,
)

GUIDE = ROOT / "docs" / "writing-a-driver.md"
FOLDER = {"README.md", "config.py", "protocol.py", "connection.py", "driver.py", "faults.py"}


written, installed = guide_package(GUIDE, "cellctl-acme")


def test_the_folder_is_complete(written: Path) -> None:
    files = {path.name for path in (written / "acme3d").iterdir()}
    assert files >= FOLDER


@pytest.mark.figures  # the next one runs the same contract, by the commands of the page
def test_the_contract_holds(written: Path, installed: Path) -> None:
    done = contract_of(written, installed)
    assert done.returncode == 0, done.stdout + done.stderr
    assert " passed" in done.stdout


def test_the_contract_is_run_as_the_page_says(written: Path, installed: Path) -> None:
    done = contract_by_hand(GUIDE, written, installed)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning" not in done.stdout


def test_the_core_finds_the_driver(installed: Path) -> None:
    script = "import cellctl.plugins as p; print(p.load(p.TARGET_TRACKER, 'acme').__name__)"
    done = subprocess.run(
        [sys.executable, "-c", script],
        env=os.environ | {"PYTHONPATH": str(installed)},
        cwd=installed,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.stdout == "AcmeTracker\n", done.stderr


@pytest.mark.figures  # beside that of the other guide in test_writing_a_robot_driver.py
def test_our_own_tests_pass_beside_it(installed: Path) -> None:
    done = registry_beside(installed)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "test_implements_its_interface[cellctl.target_tracker:acme] PASSED" in done.stdout


def test_the_code_has_the_style_of_the_house(written: Path) -> None:
    for done in style_of(written):
        assert done.returncode == 0, done.stdout + done.stderr


def test_every_interface_is_listed() -> None:
    text = GUIDE.read_text(encoding="utf-8")
    groups = re.findall(r'^\[project\.entry-points\."(cellctl\.\w+)"\]', _pyproject(), re.MULTILINE)
    missing = {group for group in groups if f"| `{group}` |" not in text}
    of_processes = ("process", "command", "calibrate", "insertion_judge")
    assert missing == {f"cellctl.{group}" for group in of_processes}


def _pyproject() -> str:
    return (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def test_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", GUIDE.read_text(encoding="utf-8")):
        assert (GUIDE.parent / target).exists(), target
