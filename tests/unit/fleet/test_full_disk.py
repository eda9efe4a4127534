"""The disk of a real server is full: the cell goes on, and what it recorded arrives later."""

import os
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy.exc import DBAPIError

from cellctl.errors.records.fleet import FleetUnreachable
from cellctl.fleet.address import PASSWORD as PASSWORD_VARIABLE
from cellctl.fleet.forwarder import Forwarder, ForwarderPace
from cellctl.records import RunStore
from cellctl.records.files.delivery_file import DeliveryState
from tests.rigs import postgres
from tests.rigs.postgres import PASSWORD, PostgresServer
from tests.unit.fleet.conftest import NORTH, Fleet, deliver_all, started
from tests.unit.fleet.test_delivery import assert_whole, everything

SIZE = "160m"
LARGE = "x" * 20_000


class SmallDisk:
    """A file system of its own that can be filled and given room again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._filler = folder / "filler"

    def fill(self) -> None:
        """Down to the last byte."""
        with self._filler.open("wb", buffering=0) as file:
            for size in (1 << 20, 1 << 12, 1):
                try:
                    while True:
                        file.write(b"x" * size)
                except OSError:
                    continue

    def give_room(self) -> None:
        self._filler.unlink()


@pytest.fixture
def disk() -> Iterator[SmallDisk]:
    if reason := postgres.missing():
        pytest.skip(reason)
    if os.geteuid() != 0:
        pytest.skip("only root mounts a small file system")
    with tempfile.TemporaryDirectory(prefix="cellctl-small-disk-") as name:
        mount = ["mount", "-t", "tmpfs", "-o", f"size={SIZE},mode=755", "tmpfs", name]
        if subprocess.run(mount, check=False, stderr=subprocess.DEVNULL).returncode:
            pytest.skip("nothing can be mounted here")
        try:
            yield SmallDisk(Path(name))
        finally:
            subprocess.run(["umount", "--lazy", name], check=True)


@pytest.fixture
def fleet(disk: SmallDisk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Fleet]:
    monkeypatch.setenv(PASSWORD_VARIABLE, PASSWORD)
    (disk.folder / "server").mkdir()
    server = started(disk.folder / "server")
    fleet = Fleet(server, tmp_path)
    yield fleet
    fleet.close()
    server.stop()


def at_work(store: RunStore) -> None:
    """More than fits into the pages that the server has already."""
    for number in range(100):
        store.audit("OP-7", "note", {"number": number, "text": f"{number} {LARGE}"})


def exhaust_the_log(server: PostgresServer) -> None:
    """Have the server begin file after file of its log of changes, until one has no room."""
    for _ in range(20):
        server.execute("CREATE TABLE IF NOT EXISTS more (n int)", "SELECT pg_switch_wal()")
        server.execute("DROP TABLE more")


def test_what_a_server_has_no_room_for_arrives_when_it_has(fleet: Fleet, disk: SmallDisk) -> None:
    store = fleet.store(NORTH)
    everything(store)
    delivery = fleet.delivery(NORTH)
    delivery.deliver(3)
    disk.fill()
    at_work(store)
    told: list[DeliveryState] = []
    waits: list[float] = []

    def wait(seconds: float) -> None:
        waits.append(seconds)
        if len(waits) == 3:
            at_work(store)
            disk.give_room()

    forwarder = Forwarder(delivery, ForwarderPace(2.0, 1.0, 3.0), wait, told.append)
    forwarder.run(until=lambda: len(waits) > 3 and told[-1].still_to_come == 0)
    assert waits[:3] == [1.0, 2.0, 3.0]
    for state in told[:3]:
        assert state.fault.startswith("F831")
        assert "No space left on device" in state.fault
    assert told[-1].fault == ""
    assert fleet.server.alive, "it has only refused"
    assert_whole(fleet, NORTH, store)


@pytest.mark.figures  # of a server that dies, and of a disk without room, each has a test above
def test_a_server_that_dies_of_its_full_disk_is_started_again(
    fleet: Fleet, disk: SmallDisk
) -> None:
    """Without room for its log of changes PostgreSQL panics: what it had confirmed is there."""
    store = fleet.store(NORTH)
    everything(store)
    delivery = fleet.delivery(NORTH)
    delivery.deliver(3)
    disk.fill()
    with pytest.raises(DBAPIError):
        exhaust_the_log(fleet.server)
    assert "PANIC" in fleet.server.log, "all its sessions are gone"
    with pytest.raises(FleetUnreachable):
        deliver_all(delivery)
    at_work(store)
    disk.give_room()
    # Whether it comes back by itself depends on what else needs room; its keeper sees to it.
    fleet.server.stop()
    fleet.server.start()
    Forwarder(delivery, ForwarderPace(0.0, 0.1, 0.1), lambda _s: None).run(
        until=lambda: delivery.deliver() == 0
    )
    assert_whole(fleet, NORTH, store)
