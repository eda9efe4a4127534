"""What systemd hears."""

import os
import socket
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from cellctl.daemon.notify import Watchdog, notify, watchdog_interval_s


@pytest.fixture
def systemd(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[socket.socket]:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as channel:
        channel.bind(str(tmp_path / "notify"))
        channel.settimeout(2)
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        yield channel


def test_a_state_is_one_datagram(systemd: socket.socket) -> None:
    notify("READY=1\nSTATUS=ready")
    assert systemd.recv(100) == b"READY=1\nSTATUS=ready"


def test_abstract_addresses(monkeypatch: pytest.MonkeyPatch) -> None:
    name = f"cellctl-test-{os.getpid()}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as channel:
        channel.bind("\0" + name)
        channel.settimeout(2)
        monkeypatch.setenv("NOTIFY_SOCKET", "@" + name)
        notify("STOPPING=1")
        assert channel.recv(100) == b"STOPPING=1"


def test_a_deaf_systemd_does_not_stop_the_cell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("NOTIFY_SOCKET", raising=False)
    notify("READY=1")
    assert capsys.readouterr().out == ""
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "nobody"))
    notify("READY=1")
    assert "systemd not told" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("usec", "pid", "expected"),
    [
        (None, None, None),
        ("3000000", None, 1.5),
        pytest.param("3000000", str(os.getpid()), 1.5, id="own process"),
        ("3000000", "1", None),
        ("0", None, None),
        ("soon", None, None),
    ],
)
def test_the_watchdog_of_this_process(
    monkeypatch: pytest.MonkeyPatch, usec: str | None, pid: str | None, expected: float | None
) -> None:
    for name, value in (("WATCHDOG_USEC", usec), ("WATCHDOG_PID", pid)):
        if value is None:
            monkeypatch.delenv(name, raising=False)
        else:
            monkeypatch.setenv(name, value)
    assert watchdog_interval_s() == expected


def test_the_watchdog_is_fed_when_it_is_due(
    systemd: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("WATCHDOG_USEC", "2000000")
    # The moment of each feeding, and once more that of the next one when it is due.
    times_s = [100.0, 100.0, 100.5, 100.99, 101.0, 101.0, 101.5]
    watchdog = Watchdog(clock=partial(next, iter(times_s)))
    for _ in range(5):
        watchdog.feed()
    systemd.setblocking(False)
    assert [systemd.recv(100) for _ in range(2)] == [b"WATCHDOG=1"] * 2
    with pytest.raises(BlockingIOError):
        systemd.recv(100)


def test_without_a_watchdog_nothing_is_fed(
    systemd: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("WATCHDOG_USEC", raising=False)
    Watchdog().feed()
    systemd.setblocking(False)
    with pytest.raises(BlockingIOError):
        systemd.recv(100)
