"""`cellctl devices` shows what a cell file needs, and says what to do where it shows nothing."""

from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from cellctl.errors.camera import ProducerUnusable
from drivers.camera.gige.commands import add
from fakes.gentl.cameras import FakeCameras
from tests.wire.gige.conftest import LEFT, RIGHT


def listed(*options: str) -> str:
    app = typer.Typer()
    add(app)
    result = CliRunner().invoke(app, list(options), env={"COLUMNS": "160"})
    if result.exception is not None:
        raise result.exception
    return result.stdout


def test_cameras_are_listed_with_a_piece_of_a_cell_file(producer: Path, fakes: FakeCameras) -> None:
    fakes.inject(RIGHT, "busy")
    said = listed("--producer", str(producer))
    assert "left eye" in said
    rows = {line.split()[0]: line.rstrip() for line in said.splitlines() if line.strip()}
    assert rows[LEFT].endswith("free")
    assert rows[RIGHT].endswith("in use")
    assert f'settings.camera.serial_number = "{LEFT}"' in said
    assert str(producer) in said
    assert fakes.opened(LEFT) == 0


def test_an_empty_network_is_said(producer: Path, fakes: FakeCameras) -> None:
    for serial in (LEFT, RIGHT):
        fakes.inject(serial, "lost")
    assert "power" in listed("--producer", str(producer))


def test_a_missing_producer_is_a_fault(tmp_path: Path) -> None:
    with pytest.raises(ProducerUnusable, match=r"none\.cti"):
        listed("--producer", str(tmp_path / "none.cti"))
