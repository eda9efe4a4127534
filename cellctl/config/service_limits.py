"""What the service of one cell needs of the PC: network peers, serial lines, SocketCAN.

Drivers name such settings alike (docs/writing-a-driver.md): ``host`` and ``robot_address`` are
network peers, a path below ``/dev`` is a device, ``can_channel`` with ``can_interface`` a CAN bus.
"""

import ipaddress
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit

from cellctl.config.cell import CellConfig, FleetConfig

_PEERS = ("host", "robot_address")
_SOCKET_CAN = "socketcan"
_HEAD = "# Made by `cellctl service-limits"


@dataclass(frozen=True, slots=True)
class ServiceLimits:
    """Everything that the cell file names, and what it leaves open."""

    peers: tuple[str, ...]
    """Addresses or networks, as they are written."""
    devices: tuple[str, ...]
    """Paths below /dev."""
    can_channels: tuple[str, ...]
    """Interfaces of SocketCAN, such as can0."""
    open_ends: tuple[str, ...]
    """Whose peers nobody can tell from the file, and why."""


def service_limits(cell: CellConfig) -> ServiceLimits:
    """The limits of one cell; every device has an address, a path, or an entry of its own."""
    peers: dict[str, None] = dict.fromkeys(_addresses(cell.plc.allowed_clients))
    devices: dict[str, None] = {}
    open_ends: list[str] = []
    channels: dict[str, None] = {}
    for path, (_, device) in cell.devices().items():
        settings = device.settings
        local = {value for value in settings.values() if _is_device(value)}
        can = settings.get("transport") == "can"
        if can and settings.get("can_interface", _SOCKET_CAN) == _SOCKET_CAN:
            channels[str(settings.get("can_channel", "can0"))] = None
        devices |= dict.fromkeys(sorted(local))
        if local or can:
            continue  # a serial line or a bus: its settings of a network mean nothing
        named = [str(settings[key]) for key in _PEERS if settings.get(key)]
        known = list(_addresses(named))
        peers |= dict.fromkeys(known)
        if not named:
            open_ends.append(f"{path} ({device.driver}) names no address")
        open_ends += [f"{path}: {name} is a name" for name in named if name not in known]
    return ServiceLimits(tuple(peers), tuple(devices), tuple(channels), tuple(open_ends))


def drop_in(name: str, limits: ServiceLimits) -> str:
    """The limits of the cell of this name as a drop-in of the unit ``cellctl.service``."""
    return "".join(f"{line}\n" for line in _lines(name, limits))


def forwarder_limits(fleet: FleetConfig) -> ServiceLimits:
    """The limits of the unit that delivers records: the server of the fleet alone."""
    host = urlsplit(fleet.url).hostname or ""
    known = tuple(_addresses([host]))
    open_ends = () if known else (f"fleet.url: {host} is a name",)
    return ServiceLimits(known, (), (), open_ends)


def forwarder_drop_in(name: str, limits: ServiceLimits) -> str:
    """The limits as a drop-in of the unit ``cellctl-forward.service``."""
    lines = (f"{_HEAD} --forwarder` from the cell file of {name}.", "[Service]", *_network(limits))
    return "".join(f"{line}\n" for line in lines)


def _lines(name: str, limits: ServiceLimits) -> Iterator[str]:
    yield f"{_HEAD}` from the cell file of {name}."
    yield "[Service]"
    yield "# The first line empties the list of the unit."
    yield "DeviceAllow="
    yield from (f"DeviceAllow={device} rw" for device in limits.devices)
    if limits.can_channels:
        yield "RestrictAddressFamilies=AF_CAN"
    yield from _network(limits)


def _network(limits: ServiceLimits) -> Iterator[str]:
    yield "IPAddressDeny=any"
    yield "IPAddressAllow=localhost"
    yield from (f"IPAddressAllow={peer}" for peer in limits.peers)
    for text in limits.open_ends:
        yield f"# {text}: add an IPAddressAllow= of its network, or it cannot be reached."


def _addresses(written: Iterable[str]) -> Iterator[str]:
    for text in written:
        try:
            ipaddress.ip_network(text, strict=False)
        except ValueError:
            continue
        yield text


def _is_device(value: Any) -> bool:
    return isinstance(value, str) and value.startswith("/dev/")
