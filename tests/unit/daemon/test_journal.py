"""What the journal is sent, over a socket as its own is."""

import io
import json
import os
import socket
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import pytest

from cellctl import log
from cellctl.daemon.journal import JournalStream, journal_or

pytestmark = pytest.mark.usefixtures("restored_logging")


class Journal:
    """Reads datagrams as the protocol says, independently of who writes them."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(path))
        self.socket.settimeout(2.0)

    def entry(self) -> dict[str, str]:
        data, found = self.socket.recv(65536), dict[str, str]()
        while data:
            name, data = data.split(b"\n", 1)
            if b"=" in name:
                field, value = name.split(b"=", 1)
            else:
                (size,) = struct.unpack("<Q", data[:8])
                field, value = name, data[8 : 8 + size]
                assert data[8 + size : 9 + size] == b"\n"
                data = data[9 + size :]
            found[field.decode()] = value.decode()
        return found


@pytest.fixture
def journal(tmp_path: Path) -> Iterator[Journal]:
    found = Journal(tmp_path / "journal")
    yield found
    found.socket.close()


@pytest.fixture
def stream(journal: Journal, stderr: TextIO) -> Iterator[JournalStream]:
    found = journal_or(stderr, journal.path)
    assert isinstance(found, JournalStream)
    yield found
    found.close()


@pytest.fixture
def stderr(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[TextIO]:
    """The stream that systemd reads."""
    with (tmp_path / "stderr").open("w+", encoding="utf-8") as stream:
        about = os.fstat(stream.fileno())
        monkeypatch.setenv("JOURNAL_STREAM", f"{about.st_dev}:{about.st_ino}")
        yield stream


def test_a_line_has_run_step_module_and_fault_as_fields(
    journal: Journal, stderr: TextIO, stream: JournalStream
) -> None:
    log.configure(stream=stream)
    log.always(lambda: {"run": 17, "step": "mate"})
    log.get("cellctl.runtime.unit").error("fault", number=512, fault="F512 50.8 N")
    entry = journal.entry()
    line = json.loads(entry.pop("MESSAGE"))
    assert (line["event"], line["fault"], line["run"]) == ("fault", "F512 50.8 N", 17)
    assert entry == {
        "SYSLOG_IDENTIFIER": "cellctl", "PRIORITY": "3", "CELL_RUN": "17", "CELL_STEP": "mate",
        "CELL_MODULE": "cellctl.runtime.unit", "CELL_FAULT": "512",
    }  # fmt: skip
    log.always(dict)
    log.get("cellctl.daemon.app").info("ended")
    assert not {"CELL_RUN", "CELL_STEP", "CELL_FAULT"} & journal.entry().keys()
    stderr.seek(0)
    assert stderr.read() == ""


def test_lines_that_are_no_json_arrive_whole(journal: Journal, stream: JournalStream) -> None:
    stream.write("Traceback\n  line two\n")
    entry = journal.entry()
    assert entry == {
        "MESSAGE": "Traceback\n  line two", "PRIORITY": "6", "SYSLOG_IDENTIFIER": "cellctl",
    }  # fmt: skip


@pytest.mark.parametrize("text", ["x" * 10_000_000 + "\n", "short\n"])
def test_what_the_journal_does_not_take_goes_to_the_stream(
    journal: Journal, stderr: TextIO, stream: JournalStream, text: str
) -> None:
    if text == "short\n":
        journal.path.unlink()  # the journal starts anew
    assert stream.write(text) == len(text)
    stream.flush()
    stderr.seek(0)
    assert stderr.read() == text


def test_a_stream_that_systemd_does_not_read_stays(
    journal: Journal, stderr: TextIO, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    memory = io.StringIO()
    assert journal_or(memory, journal.path) is memory
    with (tmp_path / "elsewhere").open("w", encoding="utf-8") as other:
        assert journal_or(other, journal.path) is other
    monkeypatch.delenv("JOURNAL_STREAM")
    assert journal_or(stderr, journal.path) is stderr


@pytest.mark.parametrize("line", ["3.14", "[1, 2]", "null"])
def test_json_that_is_no_object_arrives_whole(
    journal: Journal, stream: JournalStream, line: str
) -> None:
    stream.write(f"{line}\n")
    assert journal.entry()["MESSAGE"] == line
