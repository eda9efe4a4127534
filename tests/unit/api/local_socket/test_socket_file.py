"""The socket's life in the file system."""

import grp
import os
import socket
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

from cellctl.api.local_socket.socket_file import SocketFile, default_path
from cellctl.errors.local import CannotServeLocally, LocalApiInUse


@pytest.fixture
def file(tmp_path: Path) -> SocketFile:
    return SocketFile(tmp_path / "cellctl.sock", "")


@pytest.fixture
def dead(file: SocketFile) -> Iterator[SocketFile]:
    """What a killed daemon leaves."""
    file.open().close()
    yield file
    file.remove()


def test_group_and_owner_may_use_it_and_nobody_else(file: SocketFile) -> None:
    with file.open():
        mode = file.path.stat().st_mode
        assert stat.S_ISSOCK(mode)
        assert stat.S_IMODE(mode) == 0o660


def test_it_is_open_to_nobody_before_its_group_is_set(
    file: SocketFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    modes = []
    change = Path.chmod

    def chmod(path: Path, mode: int) -> None:
        modes.append(stat.S_IMODE(path.stat().st_mode))
        change(path, mode)

    monkeypatch.setattr(Path, "chmod", chmod)
    before = os.umask(0)
    try:
        file.open().close()
    finally:
        os.umask(before)
    assert modes == [0o600]


def test_the_group_is_the_configured_one(tmp_path: Path) -> None:
    own = grp.getgrgid(os.getgid())
    with SocketFile(tmp_path / "a.sock", own.gr_name).open():
        assert (tmp_path / "a.sock").stat().st_gid == own.gr_gid


def test_a_dead_daemons_socket_is_replaced(dead: SocketFile) -> None:
    successor = SocketFile(dead.path, "")
    with successor.open() as listener:
        listener.listen()
        with socket.socket(socket.AF_UNIX) as client:
            client.connect(str(dead.path))


def test_a_living_daemons_socket_is_not(file: SocketFile) -> None:
    with file.open() as listener:
        listener.listen()
        with pytest.raises(LocalApiInUse, match="F711"):
            SocketFile(file.path, "").open()
        with socket.socket(socket.AF_UNIX) as client:
            client.connect(str(file.path))


def test_a_daemon_too_busy_to_accept_lives(file: SocketFile) -> None:
    with file.open() as listener, socket.socket(socket.AF_UNIX) as waiting:
        listener.listen(0)
        waiting.connect(str(file.path))
        with pytest.raises(LocalApiInUse):
            SocketFile(file.path, "").open()


def test_another_file_in_its_place_is_left_alone(file: SocketFile) -> None:
    file.path.write_text("precious")
    with pytest.raises(CannotServeLocally, match="no socket"):
        file.open()
    assert file.path.read_text() == "precious"


@pytest.mark.parametrize(
    ("name", "group"),
    [("missing/cellctl.sock", ""), ("a" * 120, ""), ("cellctl.sock", "nobody-has-this-group")],
)
def test_what_cannot_be_served_is_said(tmp_path: Path, name: str, group: str) -> None:
    path = tmp_path / name
    with pytest.raises(CannotServeLocally, match="F712"):
        SocketFile(path, group).open()
    assert list(tmp_path.iterdir()) == []


def test_an_end_removes_it_but_no_successors(file: SocketFile) -> None:
    file.open().close()
    file.path.rename(file.path.with_name("moved"))
    with SocketFile(file.path, "").open():
        file.remove()
        assert file.path.exists()
    file.remove()


def test_where_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RUNTIME_DIRECTORY", raising=False)
    assert default_path(tmp_path) == tmp_path / "cellctl.sock"
    monkeypatch.setenv("RUNTIME_DIRECTORY", "/run/cellctl:/run/other")
    assert default_path(tmp_path) == Path("/run/cellctl/cellctl.sock")
