"""Network addresses, ports and names of devices, held against each other.

Drivers name such settings alike (docs/writing-a-driver.md): ``host`` is where a device listens,
``listen_host`` where this PC does, ``port`` or a key that ends in ``_port`` belongs to it.
``robot_name``, ``robot_address`` and ``serial_number`` tell one device from another.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from cellctl import plugins
from cellctl.config.cell import CellConfig
from cellctl.config.checks.hosts import host_issues
from cellctl.config.issue import ConfigIssue

_NAMES = ("robot_name", "robot_address", "serial_number")
_CONTROLLER = (
    "robot_name",
    "robot_address",
    "listen_host",
    "host",
    "rpc_port",
    "stop_word",
    "rearm_word",
    "tool",
    "work_frame",
    "euler",
)
_ANY = ("0.0.0.0", "::")
_COUPLERS = (plugins.GRIPPER, plugins.DIGITAL_IO)
"""A gripper and signals may share a coupler, which serves several connections."""


@dataclass(frozen=True, slots=True)
class _Place:
    """One port of one device, as the file says it."""

    key: str
    host: str
    port: int
    owner: str
    """The robot, for the robot and for the stop channel to it; else the device itself."""
    here: bool
    """This PC listens there, so that not even the robot and its stop channel can share it."""


def address_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Values that are no address, and addresses or names that two devices share."""
    yield from host_issues(cell)
    yield from _shared_places(cell)
    yield from _shared_names(cell)
    yield from _stop_channels(cell)
    yield from _on_a_controller(cell)


def _shared_places(cell: CellConfig) -> Iterator[ConfigIssue]:
    by_port: dict[int, list[_Place]] = defaultdict(list)
    for place in _places(cell):
        for other in by_port[place.port]:
            if _same_host(place, other) and not _may_share(place, other, cell):
                where = f"{place.host}:{place.port}"
                yield ConfigIssue(place.key, where, f"{other.key} has this address and port, too")
                break
        by_port[place.port].append(place)


def _places(cell: CellConfig) -> Iterator[_Place]:
    if cell.plc.port:  # 0 is any free port
        yield _Place("plc.port", cell.plc.host, cell.plc.port, "plc", here=True)
    for path, (_, device) in cell.devices().items():
        settings = device.settings
        if settings.get("transport", "tcp") != "tcp":
            continue  # a serial line, whose settings of a network mean nothing
        here = "host" not in settings
        host = settings.get("host", settings.get("listen_host", "127.0.0.1"))
        for name, port in settings.items():
            if (name == "port" or name.endswith("_port")) and isinstance(port, int):
                owner = _owner(path, cell)
                yield _Place(f"{path}.settings.{name}", str(host), port, owner, here)


def _owner(path: str, cell: CellConfig) -> str:
    section, name, *inner = path.split(".")
    if inner == ["stop_channel"]:
        return f"robots.{cell.force_sensors[name].mounted_on}"
    return f"{section}.{name}"


def _same_host(one: _Place, other: _Place) -> bool:
    if one.host == other.host:
        return True
    return one.here and other.here and (one.host in _ANY or other.host in _ANY)


def _may_share(one: _Place, other: _Place, cell: CellConfig) -> bool:
    if one.owner == other.owner:
        # A controller serves two clients at one port; a job program that calls has one of its own.
        return not one.here and one.key.split(".")[-1] == other.key.split(".")[-1]
    groups = [cell.devices()[place.owner][0] for place in (one, other) if place.owner != "plc"]
    return len(groups) == len([group for group in groups if group in _COUPLERS]) == 2


def _shared_names(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Two devices that would be one and the same."""
    first: dict[tuple[str, str], str] = {}
    for path, (group, device) in cell.devices().items():
        if group == plugins.STOP_CHANNEL:
            continue  # has the name of its robot, which is looked at by itself
        for key, name, value in _named(f"{path}.settings", device.settings):
            other = first.setdefault((name, value), key)
            if other != key and "/" not in value:  # a network holds several
                yield ConfigIssue(key, repr(value), f"{other} has it, too: two devices, two of it")


def _named(path: str, settings: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    for key, value in settings.items():
        if isinstance(value, Mapping):
            yield from _named(f"{path}.{key}", value)
        elif key in _NAMES and value:
            yield f"{path}.{key}", key, str(value)


def _stop_channels(cell: CellConfig) -> Iterator[ConfigIssue]:
    """A guard whose stop goes to another robot than the one it watches."""
    for name, sensor in cell.force_sensors.items():
        robot = cell.robots.get(sensor.mounted_on)
        if robot is None or robot.driver != sensor.stop_channel.driver:
            continue  # the first is reported by itself; other drivers, other words
        for key in _CONTROLLER:
            ours, theirs = sensor.stop_channel.settings.get(key), robot.settings.get(key)
            if ours != theirs:
                where = f"force_sensors.{name}.stop_channel.settings.{key}"
                value = "(missing)" if ours is None else repr(ours)
                allowed = f"as in robots.{sensor.mounted_on}.settings, which it must stop: "
                yield ConfigIssue(where, value, f"{allowed}{theirs!r}")


def _on_a_controller(cell: CellConfig) -> Iterator[ConfigIssue]:
    """A camera server or a sensor at the address of a robot's controller."""
    robots = {
        robot.settings["robot_address"]: f"robots.{name}"
        for name, robot in cell.robots.items()
        if robot.settings.get("robot_address")
    }
    for path, (_, device) in cell.devices().items():
        host = device.settings.get("host")
        if isinstance(host, str) and host in robots:
            allowed = f"another address; this one is the controller of {robots[host]}"
            yield ConfigIssue(f"{path}.settings.host", repr(host), allowed)
