"""Who logs never waits for the disk; what the disk misses is counted; order is kept."""

import io
import json
import logging
import threading
from collections.abc import Iterator

import pytest

from cellctl import log
from cellctl.log_thread import LogThread


class SlowDisk(io.StringIO):
    """Below the log: a write comes back when the disk is let go."""

    def __init__(self) -> None:
        super().__init__()
        self.asked, self.goes_on = threading.Event(), threading.Event()
        self.lost = 0

    def write(self, text: str) -> int:
        self.asked.set()
        assert self.goes_on.wait(60.0)
        if self.lost:
            super().write(f"lost {self.lost}\n")
            self.lost = 0
        return super().write(text)


@pytest.fixture
def disk() -> Iterator[SlowDisk]:
    disk = SlowDisk()
    yield disk
    disk.goes_on.set()


@pytest.mark.usefixtures("restored_logging")
def test_who_logs_does_not_wait(disk: SlowDisk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr", disk)
    ends: list[object] = []
    monkeypatch.setattr("atexit.register", ends.append)
    log.configure(beside=True)
    for number in range(3):
        log.get("cellctl.daemon").info(f"own {number}")
        logging.getLogger("drivers.robot").warning("foreign %d", number)
    # Nobody has waited: the disk has not come back from its first line yet.
    assert disk.asked.wait(60.0)
    assert disk.getvalue() == ""
    disk.goes_on.set()
    (end,) = ends
    assert callable(end)
    end(60.0)
    events = [json.loads(line)["event"] for line in disk.getvalue().splitlines()]
    assert events == [f"{who} {number}" for number in range(3) for who in ("own", "foreign")]


def test_lines_without_room_are_counted(disk: SlowDisk) -> None:
    stream = LogThread(disk, most_lines=2)
    stream.write("first\n")
    assert disk.asked.wait(60.0)
    for number in range(5):
        stream.write(f"{number}\n")
    disk.goes_on.set()
    stream.close(60.0)
    assert disk.getvalue() == "first\nlost 3\n0\n1\n"


def test_a_disk_that_hangs_keeps_nobody_from_ending(disk: SlowDisk) -> None:
    stream = LogThread(disk, most_lines=1)
    stream.write("hangs\n")
    assert disk.asked.wait(60.0)
    stream.write("waits\n")
    stream.close(0.01)
    assert disk.getvalue() == ""
