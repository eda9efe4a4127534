"""What the shipped unit of the daemon lets it do."""

from configparser import ConfigParser
from pathlib import Path

UNIT = Path(__file__).parents[3] / "systemd" / "cellctl.service"


def service() -> dict[str, str]:
    unit = ConfigParser(strict=False, interpolation=None)
    unit.optionxform = str  # type: ignore[assignment, method-assign]
    unit.read(UNIT, encoding="utf-8")
    return dict(unit["Service"])


def test_libraries_of_camera_makers_see_the_network_interfaces() -> None:
    """`getifaddrs` asks over a netlink socket; where that is refused, no camera is found."""
    families = service()["RestrictAddressFamilies"].split()
    assert {"AF_UNIX", "AF_INET", "AF_INET6", "AF_NETLINK", "AF_CAN"} == set(families)
