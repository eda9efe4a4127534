"""Faults of an installed package reach whoever reads them: terminal, page, report and guard."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl import fault_catalogue, plugins
from cellctl.cli.commands import whole_app
from cellctl.config import problems
from cellctl.guard.messages import fault_from_json
from cellctl.records.report.acceptance.faults import cause_and_remedy
from tests.unit.cell.bench import CELL_FILE

FAULTS = '''
"""What can go wrong with a label."""

from cellctl.errors import CellError, Reaction


class LabelCrooked(CellError):
    """The label is not straight."""

    number = {number}
    text = "The label is crooked"
    cause = "The roll is worn."
    remedy = "Change the roll."
    reaction = Reaction.STOP
'''
POINTS = """[cellctl.process]
labelling = {package}.process:Labelling
"""


@pytest.fixture(autouse=True)
def forgotten() -> Iterator[None]:
    """What is installed is read anew before and after each test."""
    _forget()
    yield
    for name in [name for name in sys.modules if name.startswith("labels_")]:
        del sys.modules[name]
    _forget()


def _forget() -> None:
    plugins.every.cache_clear()
    fault_catalogue.fault_modules.cache_clear()


def install(folder: Path, package: str, faults: str) -> None:
    """A package with a process and its faults; the process itself could not even be imported."""
    (folder / package).mkdir()
    (folder / package / "__init__.py").write_text("")
    (folder / package / "faults.py").write_text(faults)
    (folder / package / "process.py").write_text("raise AssertionError('nobody asked for it')\n")
    info = folder / f"{package}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(POINTS.format(package=package))


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.syspath_prepend(str(tmp_path))
    return tmp_path


def test_the_terminal_tells_a_fault_of_an_installed_package(site: Path) -> None:
    install(site, "labels_terminal", FAULTS.format(number=1801))
    done = CliRunner().invoke(whole_app(), ["faults", "1801"])
    assert done.exit_code == 0, done.output
    for words in ("F1801 The label is crooked", "The roll is worn.", "Change the roll.", "stop"):
        assert words in done.stdout
    assert "| F1801 |" in CliRunner().invoke(whole_app(), ["faults"]).stdout
    assert 1801 not in [fault.number for fault in fault_catalogue.shipped_faults()]


def test_report_and_guard_know_it_without_the_process(site: Path) -> None:
    install(site, "labels_report", FAULTS.format(number=1802))
    assert cause_and_remedy(1802) == ("The roll is worn.", "Change the roll.")
    fault = fault_from_json({"number": 1802, "detail": "by 2 mm"})
    assert str(fault) == "F1802 The label is crooked: by 2 mm"
    assert "labels_report.process" not in sys.modules


def test_a_damaged_package_takes_nobody_elses_faults_away(
    site: Path, caplog: pytest.LogCaptureFixture
) -> None:
    install(site, "labels_damaged", "import a_library_that_is_not_there\n")
    assert fault_catalogue.known_fault(207) is not None
    assert "labels_damaged" in caplog.text


def test_a_package_without_faults_is_no_damage(
    site: Path, caplog: pytest.LogCaptureFixture
) -> None:
    install(site, "labels_faultless", "")
    (site / "labels_faultless" / "faults.py").unlink()
    assert fault_catalogue.known_fault(207) is not None
    assert caplog.text == ""


def test_a_number_that_two_packages_take_is_an_error_of_the_cell(site: Path) -> None:
    install(site, "labels_one", FAULTS.format(number=1803))
    install(site, "labels_two", FAULTS.format(number=1803))
    (found,) = problems(CELL_FILE)
    assert (found.key, found.value) == ("(installed packages)", "F1803")
    assert "labels_one.faults.LabelCrooked and labels_two.faults.LabelCrooked" in found.allowed


def test_a_package_does_not_take_a_number_of_cellctl(site: Path) -> None:
    install(site, "labels_low", FAULTS.format(number=899))
    (found,) = problems(CELL_FILE)
    assert found.allowed == "a number from 1000 on for labels_low.faults.LabelCrooked"


def test_cellctl_itself_numbers_rightly() -> None:
    assert list(fault_catalogue.misnumbered()) == []
