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
"""Length of the prefix of the usual network of a machine."""
_PREFIXES = {4: _PREFIX, 6: 64}
"""The same by the version of the protocol."""
_PAIRS = (("open_valve", "close_valve"), ("opened_sensor", "closed_sensor"))
_CHANNELS = 8
"""Channels of one terminal of a coupler."""
_START_M_S2 = 1500.0 / 200.0 / 0.4
"""What the fake arm makes of a load as a joint move at full rated speed begins: 1.5 kN of 200 kg at
40 % (docs/guard.md)."""
_MUCH_LESS = 0.5
"""A controller with softer ramps than the fake's is no mistake."""
_COUPLERS = (plugins.GRIPPER, plugins.DIGITAL_IO)


def cell_remarks(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Remarks on what belongs to no process; of fake cells, whose addresses are of a PC, none on
    how these go together."""
    yield from _gripper_channels(cell)
    yield from _starts_of_joint_moves(cell)
    yield from _open_to_all(cell)
    yield from _many_clients(cell)
    yield from _in_the_internet(cell)
    if cell.simulated:
        return
    yield from _networks_of_several_robots(cell)
    yield from _relative(cell)
    yield from _other_networks(cell)
    yield from _shared_hosts(cell)


def _starts_of_joint_moves(cell: CellConfig) -> Iterator[ConfigIssue]:
    """A limit of free moves that the load's own inertia may exceed as a joint move begins.

    How fast an arm speeds up between taught joints is the controller's matter and stands in no
    cell file, so that nothing here is refused.
    """
    for name, sensor in cell.force_sensors.items():
        robot = cell.robots.get(sensor.mounted_on)
        if robot is None or robot.load is None:
            continue
        weighed_kg = robot.load.mass_kg - robot.load.not_weighed_kg
        start_m_s2 = _START_M_S2 * robot.speed_percent / 100
        if sensor.free_force_n < _MUCH_LESS * weighed_kg * start_m_s2:
            said = (
                f"{weighed_kg:g} kg took {weighed_kg * start_m_s2:.0f} N on a fake arm that begins "
                f"a joint move at speed_percent = {robot.speed_percent:g}: an arm that starts so "
                "is stopped by the guard at every move; docs/guard.md says how to find the limit"
            )
            yield ConfigIssue(
                f"force_sensors.{name}.free_force_n", f"{sensor.free_force_n:g}", said
            )


def _open_to_all(cell: CellConfig) -> Iterator[ConfigIssue]:
    if cell.plc.host in ("0.0.0.0", "::"):
        said = "listens in every network of this PC, that of the robots too; the line needs one"
        yield ConfigIssue("plc.host", repr(cell.plc.host), said)


def _many_clients(cell: CellConfig) -> Iterator[ConfigIssue]:
    """More PCs than a machine has that may command the cell: Modbus has no password."""
    for client in cell.plc.allowed_clients:
        network = ipaddress.ip_network(client, strict=False)
        if network.prefixlen < _PREFIXES[network.version]:
            said = (
                f"every PC with one of {network.num_addresses:.3g} addresses may start and stop "
                "the cell, for Modbus asks no password; the address of the line's PLC is enough"
            )
            yield ConfigIssue("plc.allowed_clients", str(list(cell.plc.allowed_clients)), said)
            return


def _in_the_internet(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Devices at addresses that are not those of a machine, nor of a PC that plays one."""
    for path, (_, device) in cell.devices().items():
        for key, written in device.settings.items():
            if isinstance(written, str) and _is_public(written):
                said = (
                    "an address of the internet, which no device of a cell has"
                    f"{', and no fake one' if cell.simulated else ''}; right if the plant gives "
                    "its machines such addresses"
                )
                yield ConfigIssue(f"{path}.settings.{key}", repr(written), said)


def _is_public(written: str) -> bool:
    return is_address(written) and ipaddress.ip_address(written).is_global


def _networks_of_several_robots(cell: CellConfig) -> Iterator[ConfigIssue]:
    """A network in place of a controller's address, in which that of another robot lies."""
    addresses = {
        name: ipaddress.ip_network(address, strict=False)
        for name, robot in cell.robots.items()
        if (address := str(robot.settings.get("robot_address", "")))
    }
    for name, network in addresses.items():
        others = [
            f"robots.{other}"
            for other, address in addresses.items()
            if other != name and address.overlaps(network)
        ]
        if network.num_addresses > 1 and others:
            said = (
                f"{', '.join(others)} may call here, too: a controller that is set up for another "
                "arm is told by its robot_name alone; right where its address changes"
            )
            written = cell.robots[name].settings["robot_address"]
            yield ConfigIssue(f"robots.{name}.settings.robot_address", repr(written), said)


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


def _gripper_channels(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Valves wired in one order and sensors in the other, and a channel far from the others.

    By convention drivers of grippers with two valves and two sensors name them so. A gripper that
    closes when it should open comes down onto its part with closed jaws.
    """
    for name, gripper in cell.grippers.items():
        path, settings = f"grippers.{name}.settings", gripper.settings
        channels = {key: settings[key] for pair in _PAIRS for key in pair if key in settings}
        if len(channels) < 4 or not all(isinstance(one, int) for one in channels.values()):
            continue
        falls = [channels[first] > channels[second] for first, second in _PAIRS]
        if falls[0] != falls[1]:
            said = (
                "the valves are in one order of opening and closing and the sensors in the other: "
                "right if they are wired so; exchanged, it closes when it is to open"
            )
            yield ConfigIssue(f"{path}.close_valve", str(channels["close_valve"]), said)
        part = settings.get("part_sensor")
        # A sensor that says that a part is held lies beside those of the jaws.
        beside = [("closed_sensor", "part_sensor")] if isinstance(part, int) else []
        channels |= {"part_sensor": part} if beside else {}
        for first, second in (*_PAIRS, *beside):
            if abs(channels[first] - channels[second]) >= _CHANNELS:
                said = (
                    f"{_CHANNELS} channels or more from {first}: right if it is on another terminal"
                )
                yield ConfigIssue(f"{path}.{second}", str(channels[second]), said)
