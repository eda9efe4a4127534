"""What the shipped unit of the daemon lets it do."""

import shutil
import subprocess
from configparser import ConfigParser
from pathlib import Path

import pytest

UNITS = ("cellctl.service", "cellctl-hmi.service", "cellctl-forward.service")
UNIT = Path(__file__).parents[3] / "systemd" / "cellctl.service"


def service() -> dict[str, str]:
    unit = ConfigParser(strict=False, interpolation=None)
    unit.optionxform = str  # type: ignore[assignment, method-assign]
    unit.read(UNIT, encoding="utf-8")
    return dict(unit["Service"])


def test_libraries_of_camera_makers_see_the_network_interfaces() -> None:
    """`getifaddrs` asks over a netlink socket; where that is refused, no camera is found."""
    families = service()["RestrictAddressFamilies"].split()
    assert {"AF_UNIX", "AF_INET", "AF_INET6", "AF_NETLINK"} == set(families)


def lines(key: str) -> list[str]:
    """Every value of a key, which may stand several times."""
    text = UNIT.read_text(encoding="utf-8")
    return [line.partition("=")[2] for line in text.splitlines() if line.startswith(f"{key}=")]


def test_serial_lines_are_open_although_the_list_of_devices_is_closed() -> None:
    assert lines("DevicePolicy") == ["closed"]
    assert {"char-ttyS rw", "char-ttyUSB rw", "char-ttyACM rw"} == set(lines("DeviceAllow"))


def test_the_guard_may_ask_for_its_priority() -> None:
    allowed, refused, again = lines("SystemCallFilter")
    assert refused.startswith("~")
    assert {"sched_setscheduler", "mlockall"} <= set(again.split())
    assert allowed == "@system-service"


@pytest.mark.parametrize("name", UNITS)
def test_a_call_that_is_refused_kills_nobody(name: str) -> None:
    """numpy asks for processors as it is loaded: records were not delivered, reports not made."""
    assert "SystemCallErrorNumber=EPERM" in UNIT.with_name(name).read_text("utf-8").splitlines()


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="no systemd-analyze here")
@pytest.mark.parametrize("name", UNITS)
def test_the_exposure_stays_low(name: str) -> None:
    command = ["systemd-analyze", "security", "--offline=true", "--threshold=20"]
    done = subprocess.run(
        [*command, UNIT.with_name(name)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-300:]
