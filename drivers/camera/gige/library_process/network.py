"""Addresses of the cameras on one interface, as its producer states them (GenTL SFNC 1.1).

Not every producer does: what it leaves out is unknown, and no reason to refuse a camera.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from ipaddress import AddressValueError, IPv4Address, IPv4Interface, NetmaskValueError
from typing import Any

from drivers.camera.gige.library_process.delivered import said
from drivers.camera.gige.library_process.trouble import GENICAM_ERRORS

_MOST = 256
"""Cameras and subnets that are asked for: a producer that states no end of them has one."""
_IN_TEXT = re.compile(r"(?<![\d.])\d{1,3}(?:\.\d{1,3}){3}(?![\d.])")


@dataclass(frozen=True, slots=True)
class Network:
    """What is known of one interface of the PC."""

    subnets: tuple[IPv4Interface, ...] = ()
    cameras: dict[str, IPv4Address] = field(default_factory=dict)
    """Addresses by the producer's id of the camera."""

    def address(self, camera_id: str, *texts: str) -> IPv4Address | None:
        """Where a camera is; ``texts`` are names of it, of which some producers make one of it."""
        if (stated := self.cameras.get(camera_id)) is not None:
            return stated
        return next((found for text in (camera_id, *texts) for found in _addresses(text)), None)

    def reaches(self, address: IPv4Address | None) -> bool | None:
        """Whether the interface has an address in the camera's subnet; None where nobody says."""
        if address is None or not self.subnets:
            return None
        return any(address in one.network for one in self.subnets)


def network(nodes: Any) -> Network:
    """What the features of an interface say; ``nodes`` is its node map."""
    cameras: dict[str, IPv4Address] = {}
    for _ in _selected(nodes, "DeviceSelector"):
        name = said(lambda: str(nodes.DeviceID.value), "")
        address = said(lambda: IPv4Address(nodes.GevDeviceIPAddress.value), None)
        if name and address:
            cameras[name] = address
    return Network(tuple(_subnets(nodes)), cameras)


def _subnets(nodes: Any) -> Iterator[IPv4Interface]:
    for _ in _selected(nodes, "GevInterfaceSubnetSelector"):
        address = _number(nodes, "GevInterfaceSubnetIPAddress", "GevInterfaceIPAddress")
        mask = _number(nodes, "GevInterfaceSubnetMask")
        if address and mask:
            try:
                yield IPv4Interface((address, str(IPv4Address(mask))))
            except (AddressValueError, NetmaskValueError):
                continue


def _number(nodes: Any, *names: str) -> int:
    """The first of these features that is there; 0 for none."""
    return next(filter(None, (_value(nodes, name) for name in names)), 0)


def _value(nodes: Any, name: str) -> int:
    return said(lambda: int(getattr(nodes, name).value), 0)


def _selected(nodes: Any, selector: str) -> Iterator[None]:
    """Select one after the other; once, where there is nothing to select."""
    node = getattr(nodes, selector, None)
    last = said(lambda: int(node.max), -1) if node is not None else -1
    if last < 0:
        yield
        return
    for number in range(min(last, _MOST) + 1):
        if _selects(node, number):
            yield


def _selects(node: Any, number: int) -> bool:
    try:
        node.value = number
    except GENICAM_ERRORS:
        return False
    return True


def _addresses(text: str) -> Iterator[IPv4Address]:
    for found in _IN_TEXT.findall(text):
        try:
            yield IPv4Address(found)
        except AddressValueError:
            continue
