"""docs/writing-a-process.md is true: its package is installed beside cellctl, and commands know it.

That it weighs parts on the small fake cell is shown in `tests/cell`.
"""

from pathlib import Path

import pytest

from tests.guides.package import ROOT, run
from tests.guides.weighing import SmallCell

MOST_LINES = 200


def test_the_package_is_short(written: Path) -> None:
    code = "\n".join(path.read_text() for path in (written / "acme_weighing").glob("*.py"))
    assert sum(bool(line.strip()) for line in code.splitlines()) < MOST_LINES


@pytest.mark.figures  # where nobody else checks types: both would write what mypy remembers
def test_its_types_hold(written: Path) -> None:
    done = run("mypy", "--strict", str(written / "acme_weighing"), path=(written, ROOT))
    assert done.returncode == 0, done.stdout


def test_check_knows_what_it_needs(small: SmallCell, installed: Path) -> None:
    done = run("cellctl", "check", str(small.file), path=(installed, ROOT))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "bracket (acme-weighing): this cell can run it" in done.stdout
    text = small.file.read_text()
    small.file.write_text(text.replace("[cameras.camera]", "[cameras.other]"))
    done = run("cellctl", "check", str(small.file), path=(installed, ROOT))
    assert done.returncode == 1
    assert "the cell lacks [cameras.camera]: looks at the plate" in done.stdout


def test_its_fault_is_told_with_its_remedy(installed: Path) -> None:
    done = run("cellctl", "faults", "1001", path=(installed, ROOT))
    assert done.returncode == 0, done.stderr
    assert "weigh the part on a scale" in done.stdout
    assert "stop" in done.stdout


def test_its_fault_is_told_in_chinese_by_what_pip_installs(installed: Path) -> None:
    done = run("cellctl", "faults", "1001", "--lang", "zh", path=(installed, ROOT))
    assert done.returncode == 0, done.stderr
    assert "工件重量不对" in done.stdout
    assert "english" not in done.stderr


def test_without_the_package_the_recipe_is_refused(small: SmallCell) -> None:
    done = run("cellctl", "check", str(small.file), path=(ROOT,))
    assert done.returncode == 1
    assert "recipes.0.process" in done.stdout
