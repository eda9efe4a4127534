"""Lines of the daemon and of drivers look alike, and the level holds for both."""

import asyncio
import errno
import gc
import io
import json
import logging
from typing import Any

import pytest

from cellctl import log
from cellctl.log import LogLevel

pytestmark = pytest.mark.usefixtures("restored_logging")


def _lines(capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    return [json.loads(line) for line in capsys.readouterr().err.splitlines()]


def test_a_driver_logs_as_the_core_does(capsys: pytest.CaptureFixture[str]) -> None:
    log.configure()
    log.always(lambda: {"run": 7})
    log.get("cellctl.daemon").info("started")
    logging.getLogger("drivers.robot").info("%s connected", "main")
    own, foreign = _lines(capsys)
    assert own.keys() == foreign.keys() == {"event", "module", "level", "timestamp", "run"}
    assert foreign["event"] == "main connected"
    assert foreign["module"] == "drivers.robot"
    assert foreign["level"] == "info"


def test_what_a_line_says_itself_goes_first(capsys: pytest.CaptureFixture[str]) -> None:
    log.configure()
    log.always(lambda: {"run": 7, "step": "mate"})
    log.get("cellctl.records").info("run closed", run=6)
    log.always(dict)
    log.get("cellctl.records").info("rest")
    closed, rest = _lines(capsys)
    assert (closed["run"], closed["step"]) == (6, "mate")
    assert not {"run", "step"} & rest.keys()


@pytest.mark.parametrize("level", LogLevel)
def test_the_level_holds_for_both(level: LogLevel, capsys: pytest.CaptureFixture[str]) -> None:
    log.configure(level=level)
    for name in LogLevel:
        log.get("own").log(getattr(logging, name), name)
        logging.getLogger("foreign").log(getattr(logging, name), name)
    wanted = list(LogLevel)[list(LogLevel).index(level) :]
    assert [line["event"] for line in _lines(capsys)] == [name for name in wanted for _ in range(2)]


class FullDisk(io.StringIO):
    """Below the log: takes nothing while it is full."""

    full = True

    def write(self, text: str) -> int:
        if self.full:
            raise OSError(errno.ENOSPC, "No space left on device")
        return super().write(text)

    def flush(self) -> None:
        if self.full:
            raise OSError(errno.ENOSPC, "No space left on device")


def test_a_full_disk_keeps_nobody_from_going_on(monkeypatch: pytest.MonkeyPatch) -> None:
    disk = FullDisk()
    monkeypatch.setattr("sys.stderr", disk)
    log.configure()
    logger = log.get("cellctl.runtime.unit")
    logger.error("fault")
    logging.getLogger("drivers.robot").warning("lost")
    disk.full = False
    logger.info("again")
    first, second = (json.loads(line) for line in disk.getvalue().splitlines())
    assert first == {"event": "log lines lost", "count": 2}
    assert second["event"] == "again"


def test_a_stream_that_was_closed_keeps_nobody_from_logging() -> None:
    stream = io.StringIO()
    log.configure(stream=stream)
    stream.close()
    log.get("cellctl.guard").warning("stopping")


async def _fails() -> None:
    raise ZeroDivisionError("nobody looks")


def test_a_task_that_nobody_holds_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    async def leave_it() -> None:
        asyncio.get_running_loop().create_task(_fails(), name="left alone")
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        gc.collect()

    log.configure()
    log.always(lambda: {"run": 7})
    asyncio.run(leave_it())
    (line,) = _lines(capsys)
    assert line["event"].startswith("Task exception was never retrieved")
    assert "left alone" in line["event"]
    assert "nobody looks" in line["exception"]
    assert (line["level"], line["run"]) == ("error", 7)


def test_warnings_of_asyncio_are_not_told(capsys: pytest.CaptureFixture[str]) -> None:
    log.configure()
    logging.getLogger("asyncio").warning("socket.send() raised exception.")
    assert _lines(capsys) == []
