"""What may well be meant as it stands, and was a slip often enough to be looked at again.

`cellctl check` shows these beside a file that is good; they never make it bad.
"""

import ipaddress
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from cellctl import plugins
from cellctl.config.cell import CellConfig
from cellctl.config.checks.hosts import is_address
from cellctl.config.issue import ConfigIssue

_PREFIX = 24
"""Of the usual network of a machine."""
_COUPLERS = (plugins.GRIPPER, plugins.DIGITAL_IO)


def cell_remarks(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Remarks on what belongs to no process; fake cells, all of whose addresses are of this PC,
    have none."""
    if cell.simulated:
        return
    yield from _open_to_all(cell)
    yield from _relative(cell)
    yield from _other_networks(cell)
    yield from _shared_hosts(cell)


def _open_to_all(cell: CellConfig) -> Iterator[ConfigIssue]:
    if cell.plc.host in ("0.0.0.0", "::"):
        said = "listens in every network of this PC, that of the robots too; the line needs one"
        yield ConfigIssue("plc.host", repr(cell.plc.host), said)


def _relative(cell: CellConfig) -> Iterator[ConfigIssue]:
    if not Path(cell.data_dir).is_absolute():
        said = (
            "relative to where the daemon is started: another place, another run store; the "
            "service keeps its own in /var/lib/cellctl"
        )
        yield ConfigIssue("data_dir", repr(cell.data_dir), said)


def _other_networks(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Controllers in another network than the address at which this PC waits for them."""
    for name, robot in cell.robots.items():
        here = str(robot.settings.get("listen_host", ""))
        there = str(robot.settings.get("robot_address", ""))
        if not (is_address(here) and is_address(there)):
            continue
        network = ipaddress.ip_network(f"{here}/{_PREFIX}", strict=False)
        if here not in ("0.0.0.0", "::") and ipaddress.ip_address(there) not in network:
            said = f"not in {network}, where listen_host = {here!r} is: a robot is seldom routed"
            yield ConfigIssue(f"robots.{name}.settings.robot_address", repr(there), said)


def _shared_hosts(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Two devices at one address, which may be one server with two ports."""
    found: dict[str, list[str]] = defaultdict(list)
    for path, (group, device) in cell.devices().items():
        host = device.settings.get("host")
        if isinstance(host, str) and group not in (*_COUPLERS, plugins.STOP_CHANNEL):
            found[host].append(path)
    for host, paths in found.items():
        for path in paths[1:]:
            said = f"{paths[0]} is at this address, too: right where one server serves both"
            yield ConfigIssue(f"{path}.settings.host", repr(host), said)
