"""Addresses as producers state them: all of them, some, or none."""

from ipaddress import IPv4Address, IPv4Interface
from types import SimpleNamespace
from typing import Any

import pytest
from genicam import genapi

from drivers.camera.gige.library_process.network import Network, network
from drivers.camera.gige.library_process.producers import _state
from drivers.camera.gige.protocol import CameraState

CAMERAS = {"one": 0xC0A80A15, "two": 0x0A000005}
READWRITE, READONLY, NOACCESS, BUSY = 1, 2, 3, 4


class Selector:
    """A selector of 0 to its last; the others are values of what it selects."""

    def __init__(self, last: int) -> None:
        self.max = last
        self.value = 0


class InterfaceNodes:
    """The node map of an interface with two subnets and two cameras."""

    def __init__(self) -> None:
        self.DeviceSelector = Selector(1)
        self.GevInterfaceSubnetSelector = Selector(1)

    def __getattr__(self, name: str) -> Any:
        device, subnet = self.DeviceSelector.value, self.GevInterfaceSubnetSelector.value
        values = {
            "DeviceID": list(CAMERAS)[device],
            "GevDeviceIPAddress": list(CAMERAS.values())[device],
            "GevInterfaceSubnetIPAddress": [0xC0A80A01, 0xAC100001][subnet],
            "GevInterfaceSubnetMask": [0xFFFFFF00, 0xFFFF0000][subnet],
        }
        if name not in values:
            raise AttributeError(name)
        return SimpleNamespace(value=values[name])


def test_all_that_an_interface_says() -> None:
    there = network(InterfaceNodes())
    assert there.subnets == (IPv4Interface("192.168.10.1/24"), IPv4Interface("172.16.0.1/16"))
    assert there.address("one") == IPv4Address("192.168.10.21")
    assert there.reaches(there.address("one")) is True
    assert there.reaches(there.address("two")) is False
    assert there.reaches(there.address("three")) is None


def test_an_interface_that_says_nothing() -> None:
    there = network(SimpleNamespace())
    assert there == Network()
    assert there.reaches(IPv4Address("10.0.0.5")) is None


def test_an_interface_whose_features_cannot_be_read() -> None:
    class Refusing:
        @property
        def value(self) -> int:
            raise genapi.AccessException("Node is not readable", "", 0)

        max = value

    names = ("DeviceSelector", "DeviceID", "GevDeviceIPAddress", "GevInterfaceSubnetIPAddress")
    assert network(SimpleNamespace(**{name: Refusing() for name in names})) == Network()


def test_a_mask_with_holes_is_no_subnet() -> None:
    nodes = SimpleNamespace(
        GevInterfaceSubnetIPAddress=SimpleNamespace(value=0xC0A80A01),
        GevInterfaceSubnetMask=SimpleNamespace(value=0xFF00FF00),
    )
    assert network(nodes).subnets == ()


@pytest.mark.parametrize(
    ("name", "address"),
    [
        ("GEV_192.168.10.21", "192.168.10.21"),
        ("Maker cam (00:11:22) 10.0.0.5", "10.0.0.5"),
        ("firmware 1.2.3.4.5", None),
        ("999.1.1.1", None),
        ("00-11-22-33-44-55", None),
    ],
)
def test_an_address_in_a_name(name: str, address: str | None) -> None:
    expected = None if address is None else IPv4Address(address)
    assert Network().address("id", name) == expected


@pytest.mark.parametrize(
    ("status", "reached", "state"),
    [
        (READWRITE, True, CameraState.FREE),
        (READWRITE, None, CameraState.FREE),
        (READWRITE, False, CameraState.OUT_OF_REACH),
        (READONLY, True, CameraState.IN_USE),
        (BUSY, None, CameraState.IN_USE),
        (NOACCESS, None, CameraState.OUT_OF_REACH),
        (NOACCESS, False, CameraState.OUT_OF_REACH),
        (NOACCESS, True, CameraState.IN_USE),
    ],
)
def test_whether_a_camera_can_be_opened(
    status: int, reached: bool | None, state: CameraState
) -> None:
    assert _state(status, reached=reached) is state
