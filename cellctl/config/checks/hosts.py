"""Addresses and host names, each by itself. Nothing is looked up in a network."""

import ipaddress
import re
from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue

_HOSTS = ("host", "listen_host", "robot_address")
_NAME = re.compile(r"[A-Za-z0-9_]([A-Za-z0-9_.-]*[A-Za-z0-9_])?")
_BARE = re.compile(r"^\s*(?:\w+://)?([^/\s]*?)(?::\d+)?(?:/.*)?\s*$")
"""What is left of an URL, or of an address with its port, when both are taken away."""


def host_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Values that are no address, and values that hold more than one."""
    for key, host in written_hosts(cell).items():
        if allowed := _not_a_host(key, host):
            yield ConfigIssue(key, repr(host), allowed)


def written_hosts(cell: CellConfig) -> dict[str, str]:
    """Addresses and host names of the line and of all devices, by their keys."""
    written = {"plc.host": cell.plc.host}
    for path, (_, device) in cell.devices().items():
        for name in _HOSTS:
            if isinstance(value := device.settings.get(name), str):
                written[f"{path}.settings.{name}"] = value
    return written


def is_address(text: str) -> bool:
    """True for an IPv4 or IPv6 address, in contrast to a host name."""
    try:
        ipaddress.ip_address(text)
    except ValueError:
        return False
    return True


def _not_a_host(key: str, host: str) -> str:
    # A controller's address may be a network; an empty one is left to the driver.
    if not host or is_address(host) or (key.endswith(".robot_address") and _is_network(host)):
        return ""
    # Digits and dots alone are meant as an address; a host name may be anything else.
    if re.fullmatch(r"[\d.]+", host):
        return "an IPv4 address has four numbers from 0 to 255, such as 192.168.20.11"
    if _NAME.fullmatch(host):
        return ""
    bare = _BARE.match(host)
    meant = f"did you mean '{bare[1]}'? " if bare and (_NAME.fullmatch(bare[1])) else ""
    return f"{meant}an address or a host name alone; a port has a key of its own"


def _is_network(text: str) -> bool:
    try:
        ipaddress.ip_network(text, strict=False)
    except ValueError:
        return False
    return True
