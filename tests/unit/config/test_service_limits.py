"""The drop-in of the service names what the cell file names, and nothing else."""

import shutil
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.config import CellConfig
from cellctl.config.service_limits import drop_in, service_limits
from tests.rigs.shipped import shipped_cell

CONFIG = Path(__file__).parents[3] / "config"


@pytest.fixture(scope="module")
def template() -> CellConfig:
    return shipped_cell("cell.toml")


def changed(cell: CellConfig, **settings: Any) -> CellConfig:
    """The same cell with other settings of its force sensor."""
    name, sensor = next(iter(cell.force_sensors.items()))
    other = sensor.model_copy(update={"settings": {**sensor.settings, **settings}})
    return cell.model_copy(update={"force_sensors": {name: other}})


def drop_in_of(cell: CellConfig) -> str:
    return drop_in(cell.name, service_limits(cell))


def test_every_address_of_the_file_is_a_peer(template: CellConfig) -> None:
    peers = service_limits(template).peers
    for _, device in template.devices().values():
        for key in ("host", "robot_address"):
            if key in device.settings:
                assert device.settings[key] in peers
    assert set(template.plc.allowed_clients) <= set(peers)
    assert service_limits(template).open_ends == ()


def test_all_else_is_denied(template: CellConfig) -> None:
    lines = drop_in_of(template).splitlines()
    assert "IPAddressDeny=any" in lines
    assert "DeviceAllow=" in lines
    assert not any(line.startswith("DeviceAllow=/") for line in lines)
    assert not any("AF_CAN" in line for line in lines)


def test_a_serial_sensor_is_its_line_alone(template: CellConfig) -> None:
    cell = changed(template, transport="serial", device="/dev/ttyUSB0")
    assert service_limits(cell).devices == ("/dev/ttyUSB0",)
    assert "192.168.0.108" not in service_limits(cell).peers
    assert "DeviceAllow=/dev/ttyUSB0 rw" in drop_in_of(cell).splitlines()


@pytest.mark.parametrize(("interface", "needed"), [("socketcan", True), ("slcan", False)])
def test_socket_can_is_allowed_where_it_is_used(
    template: CellConfig, interface: str, needed: bool
) -> None:
    cell = changed(template, transport="can", can_interface=interface, can_channel="can0")
    assert bool(service_limits(cell).can_channels) is needed
    assert ("RestrictAddressFamilies=AF_CAN" in drop_in_of(cell)) is needed


def test_what_nobody_can_tell_is_told(template: CellConfig) -> None:
    cell = changed(template, host="sensor-box")
    (text,) = service_limits(cell).open_ends
    assert "sensor-box is a name" in text
    done = CliRunner().invoke(whole_app(), ["service-limits", str(CONFIG / "deck-gige.toml")])
    assert done.exit_code == 0, done.output
    assert "names no address" in done.stderr
    assert "IPAddressDeny=any" in done.stdout


@pytest.mark.parametrize(
    ("host", "peers"),
    [("192.168.7.2:5433", ["192.168.7.2"]), ("[fd00::2]", ["fd00::2"]), ("db.plant", [])],
)
def test_the_forwarder_reaches_the_server_of_the_fleet_alone(
    tmp_path: Path, host: str, peers: list[str]
) -> None:
    shutil.copytree(CONFIG, tmp_path / "config")
    file = tmp_path / "config" / "deck.toml"
    with file.open("a", encoding="utf-8") as cell:
        cell.write(f'\n[fleet]\nurl = "postgresql://forward@{host}/fleet"\n')
    done = CliRunner().invoke(whole_app(), ["service-limits", "--forwarder", str(file)])
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert "IPAddressDeny=any" in lines
    allowed = [line.partition("=")[2] for line in lines if line.startswith("IPAddressAllow=")]
    assert allowed == ["localhost", *peers]
    assert bool(done.stderr) == (not peers)


def test_without_a_fleet_nothing_is_delivered() -> None:
    done = CliRunner().invoke(
        whole_app(), ["service-limits", "--forwarder", str(CONFIG / "deck.toml")]
    )
    assert done.exit_code != 0
