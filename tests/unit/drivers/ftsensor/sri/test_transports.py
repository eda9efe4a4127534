"""TCP and serial line: bytes both ways, and every way in which a link ends."""

import os
import pty
import resource
import socket
import time
from collections.abc import Iterator
from typing import Any

import pytest

from cellctl.errors.link import ConnectTimeout, LinkLost
from drivers.ftsensor.sri.connection import Connection
from drivers.ftsensor.sri.transports.serial_line import SerialConnection
from drivers.ftsensor.sri.transports.tcp import TcpConnection

WITHIN_S = 5.0


@pytest.fixture
def box() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        listening.settimeout(WITHIN_S)
        yield listening


def calling(box: socket.socket) -> TcpConnection:
    return TcpConnection("127.0.0.1", box.getsockname()[1])


def stand(connection: Connection) -> None:
    deadline_s = time.monotonic() + WITHIN_S
    while not connection.established():
        assert time.monotonic() < deadline_s, "not established"
        connection.wait(0.1)


def received(connection: Connection) -> bytes:
    connection.wait(WITHIN_S)
    return connection.receive()


def test_tcp_carries_commands_and_samples(box: socket.socket) -> None:
    connection = calling(box)
    assert connection.fileno() == -1
    connection.connect()
    peer, _ = box.accept()
    with peer:
        stand(connection)
        assert connection.established(), "asked once more it still stands"
        connection.send(b"AT+GSD\r\n")
        assert peer.recv(100) == b"AT+GSD\r\n"
        assert connection.receive() == b""
        peer.sendall(b"\xaa\x55")
        assert received(connection) == b"\xaa\x55"
        assert connection.fileno() >= 0
    connection.close()
    connection.close()
    assert connection.fileno() == -1


def test_a_box_that_hangs_up_is_a_lost_link_and_can_be_called_again(box: socket.socket) -> None:
    connection = calling(box)
    connection.connect()
    box.accept()[0].close()
    stand(connection)
    with pytest.raises(LinkLost, match="force sensor at 127"):
        received(connection)
    assert connection.fileno() == -1
    connection.connect()
    with box.accept()[0]:
        stand(connection)
    connection.close()


def test_a_port_where_nobody_listens_is_named(box: socket.socket) -> None:
    connection = calling(box)
    box.close()
    with pytest.raises(ConnectTimeout, match="ECONNREFUSED"):  # noqa: PT012
        connection.connect()
        stand(connection)


def test_a_name_that_does_not_resolve_is_named() -> None:
    connection = TcpConnection("box.invalid", 4008)
    with pytest.raises(ConnectTimeout, match=r"box\.invalid:4008"):
        connection.connect()


@pytest.fixture
def lookups(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Hosts that were looked up."""
    looked_up: list[str] = []
    look_up = socket.getaddrinfo

    def counted(host: str, port: int, *, type: int) -> Any:  # noqa: A002 - named by the library
        looked_up.append(host)
        return look_up(host, port, type=type)

    monkeypatch.setattr(socket, "getaddrinfo", counted)
    return looked_up


def test_a_box_that_has_answered_is_called_again_without_a_lookup(
    box: socket.socket, lookups: list[str]
) -> None:
    connection = calling(box)
    for _ in range(2):
        connection.connect()
        with box.accept()[0]:
            stand(connection)
    connection.close()
    assert lookups == ["127.0.0.1"]


def test_a_box_that_has_not_answered_is_looked_up_again(
    box: socket.socket, lookups: list[str]
) -> None:
    connection = calling(box)
    box.close()
    for _ in range(2):
        with pytest.raises(ConnectTimeout):  # noqa: PT012
            connection.connect()
            stand(connection)
    assert lookups == ["127.0.0.1"] * 2


def test_a_broken_tcp_link_says_so_when_it_sends(box: socket.socket) -> None:
    connection = calling(box)
    connection.connect()
    stand(connection)
    peer, _ = box.accept()
    # The peer answers with a reset, as a box that has restarted does.
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\x01\0\0\0\0\0\0\0")
    peer.close()
    with pytest.raises(LinkLost):  # noqa: PT012
        for _ in range(100):
            connection.send(b"x")
    assert connection.fileno() == -1


@pytest.fixture
def line() -> Iterator[tuple[int, str]]:
    """The box's end of a serial line, and the device's name of the other one."""
    ours, theirs = pty.openpty()
    name = os.ttyname(theirs)
    os.close(theirs)
    yield ours, name
    os.close(ours)


def test_a_serial_line_carries_commands_and_samples(line: tuple[int, str]) -> None:
    ours, device = line
    connection = SerialConnection(device, 115200)
    assert connection.fileno() == -1
    connection.connect()
    assert connection.established()
    connection.send(b"AT+GSD\r\n")
    assert os.read(ours, 100) == b"AT+GSD\r\n"
    os.write(ours, b"\xaa\x55")
    assert received(connection) == b"\xaa\x55"
    assert connection.receive() == b""
    connection.close()
    connection.close()
    assert not connection.established()


def test_a_serial_line_that_somebody_else_has_open_is_refused(line: tuple[int, str]) -> None:
    first, second = (SerialConnection(line[1], 115200) for _ in range(2))
    first.connect()
    with pytest.raises(ConnectTimeout, match="lock"):
        second.connect()
    first.close()
    second.connect()
    second.close()


def test_a_device_that_is_not_there_is_named() -> None:
    with pytest.raises(ConnectTimeout, match="/dev/ttyUSB97"):
        SerialConnection("/dev/ttyUSB97", 115200).connect()


def test_a_serial_adapter_that_is_pulled_is_a_lost_link() -> None:
    for lost in "send", "receive":
        ours, theirs = pty.openpty()
        connection = SerialConnection(os.ttyname(theirs), 115200)
        os.close(theirs)
        connection.connect()
        os.close(ours)
        with pytest.raises(LinkLost):
            connection.send(b"x") if lost == "send" else received(connection)
        assert not connection.established()


@pytest.mark.parametrize(
    "connection", [TcpConnection("127.0.0.1", 9), SerialConnection("/dev/ttyUSB97", 115200)]
)
def test_nothing_goes_over_a_link_that_was_not_opened(connection: Connection) -> None:
    for use in (lambda: connection.send(b"x"), connection.receive):
        with pytest.raises(LinkLost, match="not connected"):
            use()
    connection.wait(0.0)
    assert connection.fileno() == -1


def test_tcp_that_was_not_opened_is_not_waited_for() -> None:
    with pytest.raises(LinkLost, match="not connected"):
        TcpConnection("127.0.0.1", 9).established()


def test_a_serial_line_that_cannot_be_opened_to_its_end_is_told(line: tuple[int, str]) -> None:
    """The device can be opened, and what else it takes cannot."""
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    free = os.dup(0)
    os.close(free)
    resource.setrlimit(resource.RLIMIT_NOFILE, (free + 1, limits[1]))
    try:
        with pytest.raises(ConnectTimeout, match="Too many open files"):
            SerialConnection(line[1], 115200).connect()
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)


def test_a_name_that_cannot_be_one_is_told() -> None:
    with pytest.raises(ConnectTimeout, match="label"):
        TcpConnection("box..local", 4008).connect()
