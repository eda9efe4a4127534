"""Addresses of this PC where those of the line or of a device belong."""

import ipaddress
from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.checks.hosts import is_address
from cellctl.config.issue import ConfigIssue


def line_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """A list of clients, or a device, that has this PC in place of the other end."""
    plc = cell.plc
    own = _own_addresses(cell)
    for path, (_, device) in cell.devices().items():
        for name in ("host", "robot_address"):
            if (host := device.settings.get(name)) in own:
                allowed = "the address of the device; this PC itself has this one (listen_host)"
                yield ConfigIssue(f"{path}.settings.{name}", repr(host), allowed)
    for client in plc.allowed_clients:
        if client in own:
            allowed = (
                "addresses of the line's PLC; this one is of this PC. A program on this PC needs "
                "none: host = '127.0.0.1'"
            )
            yield ConfigIssue("plc.allowed_clients", str(list(plc.allowed_clients)), allowed)
            return


def _own_addresses(cell: CellConfig) -> set[str]:
    """Addresses at which this PC listens, but for those that every PC has."""
    listened = {
        str(device.settings.get("listen_host", "")) for _, device in cell.devices().values()
    }
    return {
        host
        for host in listened | {cell.plc.host}
        if is_address(host)
        and not ipaddress.ip_address(host).is_loopback
        and not ipaddress.ip_address(host).is_unspecified
    }
