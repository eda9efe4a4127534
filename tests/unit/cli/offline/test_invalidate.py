"""`cellctl calibrate invalidate`: by hand, with a reason, on record."""

from datetime import timedelta
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.calibration.store.marker import require_not_invalidated
from cellctl.calibration.store.store import CalibrationStore
from cellctl.cli.commands import whole_app
from cellctl.cli.nearest_cell import SERVICE_CELL
from cellctl.cli.os_user import terminal_user
from cellctl.errors.calibration import CalibrationInvalidated, CalibrationMissing
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS
from cellctl.records.store import RunStore
from tests.unit.calibration.store.shipped import renew_calibrations
from tests.unit.cell.bench import CELL_FILE

ARGUMENTS = ("--reason", "camera knocked", "--by", "OP-3")


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    text = CELL_FILE.read_text(encoding="utf-8")
    text = text.replace("demo-calibration", "calibration")
    (tmp_path / "features").symlink_to(CELL_FILE.parent / "features")
    (tmp_path / "cell.toml").write_text(text.replace("runs/cell", str(tmp_path / "store")))
    renew_calibrations(tmp_path / "calibration")
    return tmp_path / "cell.toml"


def invalidate(cell: Path, name: str) -> str:
    arguments = ["calibrate", "invalidate", name, *ARGUMENTS, "--cell", str(cell)]
    result = CliRunner().invoke(whole_app(), arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_production_is_refused_and_the_store_knows_who_said_so(cell: Path) -> None:
    RunStore(cell.parent / "store").close()
    assert "head_1 is invalid until it is made anew by procedure 101: camera" in invalidate(
        cell, "head_1"
    )
    calibrations = CalibrationStore(cell.parent / "calibration", CALIBRATIONS)
    fault = calibrations.fault(CALIBRATIONS, timedelta(0))
    assert isinstance(fault, CalibrationInvalidated)
    assert "camera knocked (OP-3)" in fault.detail
    store = RunStore(cell.parent / "store", create=False)
    (known,) = store.calibrations()
    (entry,) = store.audit_log()
    store.close()
    assert (entry.actor, entry.detail["by"]) == (terminal_user(), "OP-3")
    assert known.kind == "head_1"


def test_the_calibrations_of_a_demonstration_lie_elsewhere(cell: Path) -> None:
    elsewhere = cell.parent / "run" / "calibration"
    renew_calibrations(elsewhere)
    words = ["calibrate", "invalidate", "head_1", *ARGUMENTS, "--cell", str(cell)]
    words += ["--calibration-dir", str(elsewhere)]
    assert CliRunner().invoke(whole_app(), words, catch_exceptions=False).exit_code == 0
    require_not_invalidated(cell.parent / "calibration", "head_1")
    with pytest.raises(CalibrationInvalidated):
        require_not_invalidated(elsewhere, "head_1")


@pytest.mark.skipif(SERVICE_CELL.exists(), reason="this PC has a cell")
def test_without_a_service_the_cell_file_is_asked_for() -> None:
    done = CliRunner().invoke(whole_app(), ["calibrate", "invalidate", "head_1", *ARGUMENTS])
    assert done.exit_code == 2
    assert "--cell" in done.output


def test_it_holds_without_a_store_too(cell: Path) -> None:
    assert "not in the audit log" in invalidate(cell, "payload")
    with pytest.raises(CalibrationInvalidated):
        require_not_invalidated(cell.parent / "calibration", "payload")


def test_a_mistyped_name_is_said(cell: Path) -> None:
    with pytest.raises(CalibrationMissing, match="head_3"):
        invalidate(cell, "head_3")


def test_a_name_that_is_misspelt_is_told_with_those_that_are_there(cell: Path) -> None:
    arguments = ["calibrate", "invalidate", "payloda", *ARGUMENTS, "--cell", str(cell)]
    with pytest.raises(CalibrationMissing, match=r"did you mean 'payload'.* there: base_frame, "):
        CliRunner().invoke(whole_app(), arguments, catch_exceptions=False)
