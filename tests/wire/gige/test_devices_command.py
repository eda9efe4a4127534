"""`cellctl devices` shows what a cell file needs, and says what to do where it shows nothing."""

import json
import tomllib
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner, Result

from cellctl.errors.camera import ProducerUnusable
from drivers.camera.gige.commands import add
from drivers.camera.gige.config import GigeCameraConfig, GigeHeadConfig
from drivers.camera.gige.producer_files import PRODUCER_PATH
from fakes.gentl.cameras import FakeCamera, FakeCameras
from tests.wire.gige.conftest import LEFT, RIGHT


def ran(*options: str, **environment: str) -> Result:
    app = typer.Typer()
    add(app)
    result = CliRunner().invoke(app, list(options), env={"COLUMNS": "160"} | environment)
    if result.exception is not None:
        raise result.exception
    return result


def listed(producer: Path) -> str:
    return ran("--producer", str(producer)).stdout


def rows(said: str) -> dict[str, str]:
    """The lines of the table, by the serial number of the camera."""
    return {line.split()[0]: line.rstrip() for line in said.splitlines() if line.strip()}


def test_cameras_are_listed_with_a_piece_of_a_cell_file(producer: Path, fakes: FakeCameras) -> None:
    fakes.inject(LEFT, "busy")
    said = listed(producer)
    assert rows(said)[LEFT].split()[-3:] == ["in", "use", producer.name]
    assert rows(said)[RIGHT].split()[-2:] == ["free", producer.name]
    assert {"left", "eye", "192.168.10.21"} <= set(rows(said)[LEFT].split())
    plain = json.loads(ran("--json", "--producer", str(producer)).stdout)
    assert {one["serial_number"]: one["state"] for one in plain} == {LEFT: "in use", RIGHT: "free"}
    assert {one["producer"] for one in plain} == {str(producer)}
    piece = said.partition("[cameras.eye]")[2].replace("or both as a stereo head:", "")
    cell = tomllib.loads("[cameras.eye]" + piece)
    # The camera that can be opened now is the one that is proposed.
    eye = GigeCameraConfig(**cell["cameras"]["eye"]["settings"])
    assert (eye.camera.serial_number, eye.producers) == (RIGHT, (producer,))
    head = GigeHeadConfig(**cell["stereo_cameras"]["head_1"]["settings"])
    assert {head.left.serial_number, head.right.serial_number} == {LEFT, RIGHT}
    assert fakes.opened(RIGHT) == 0


def test_a_camera_of_another_subnet_is_shown_as_such(tmp_path: Path, producer: Path) -> None:
    cameras = [FakeCamera(LEFT, address="10.0.0.5"), FakeCamera(RIGHT)]
    with FakeCameras(tmp_path / "cameras", cameras) as fakes:
        said = ran("--producer", str(producer), FAKE_GENTL_STATE=str(fakes.path)).stdout
    assert rows(said)[LEFT].split()[-3:-1] == ["other", "subnet"]
    assert "10.0.0.5" in rows(said)[LEFT]


def test_a_long_name_is_shown_whole(tmp_path: Path, producer: Path) -> None:
    name = "0123456789" * 5
    with FakeCameras(tmp_path / "cameras", [FakeCamera(LEFT, name)]) as fakes:
        where = {"FAKE_GENTL_STATE": str(fakes.path), "COLUMNS": "80"}
        said = ran("--producer", str(producer), **where).stdout
    assert LEFT in said
    assert "…" not in said


def test_a_name_is_shown_and_written_as_it_is(tmp_path: Path, producer: Path) -> None:
    """Brackets are no mark-up of the terminal, quotes no end of a text in TOML."""
    cameras = [FakeCamera('A"1', "eye [left] :100:")]
    with FakeCameras(tmp_path / "cameras", cameras) as fakes:
        said = ran("--producer", str(producer), FAKE_GENTL_STATE=str(fakes.path)).stdout
    assert "eye [left] :100:" in said
    cell = tomllib.loads("[cameras.eye]" + said.partition("[cameras.eye]")[2])
    assert cell["cameras"]["eye"]["settings"]["camera"]["serial_number"] == 'A"1'


def test_an_empty_network_is_said(producer: Path, fakes: FakeCameras) -> None:
    for serial in (LEFT, RIGHT):
        fakes.inject(serial, "lost")
    assert "power" in listed(producer)


def test_a_missing_producer_is_a_fault(tmp_path: Path) -> None:
    with pytest.raises(ProducerUnusable, match=r"none\.cti"):
        listed(tmp_path / "none.cti")


def test_without_a_producer_the_variable_is_named() -> None:
    with pytest.raises(ProducerUnusable, match=PRODUCER_PATH):
        ran(**{PRODUCER_PATH: ""})


def test_a_bad_producer_hides_no_other(tmp_path: Path, producer: Path, fakes: FakeCameras) -> None:
    (tmp_path / "a.cti").write_bytes(b"no library")
    folders = f"{tmp_path}:{producer.parent}"
    result = ran(**{PRODUCER_PATH: folders})
    assert {LEFT, RIGHT} <= set(rows(result.stdout))
    assert "F223" in result.stderr
    assert "a.cti" in result.stderr
