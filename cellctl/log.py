"""Structured logs: for people on a terminal, JSON otherwise; run and step on every line."""

import atexit
import logging
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, TextIO, cast

import structlog
from structlog.stdlib import ProcessorFormatter
from structlog.typing import EventDict, Processor, WrappedLogger

from cellctl.log_thread import LogThread

QUIET_LOGGERS = ("pymodbus.logging", "can", "transitions.core", "transitions")
"""Of libraries whose errors reach the log by the exceptions that they raise."""


class LogLevel(StrEnum):
    """What is logged at least."""

    DEBUG = "DEBUG"
    INFO = "INFO"
    WARNING = "WARNING"
    ERROR = "ERROR"


Facts = Callable[[], Mapping[str, object]]


@dataclass(slots=True)
class _Said:
    """What every line says."""

    facts: Facts = dict


_said = _Said()


class LineStream(Protocol):
    """Where lines go; a text file is one."""

    def write(self, text: str, /) -> int:
        """A whole line; raises ``OSError``."""

    def flush(self) -> None:
        """Likewise."""

    def isatty(self) -> bool:
        """True for a terminal."""


class UnfailingStream:
    """Where log lines go: one that cannot be written is counted, and never raises.

    Who logs may be about to stop an arm. A full disk under the log must not keep it from that.
    """

    def __init__(self, stream: LineStream) -> None:
        self._stream = stream
        self.lost = 0
        """Lines that could not be written since the last that could."""

    def write(self, text: str) -> int:
        """All of the text, or nothing that anybody hears of before the next line."""
        try:
            if self.lost:
                self._stream.write(f'{{"event": "log lines lost", "count": {self.lost}}}\n')
                self.lost = 0
            self._stream.write(text)
        # A stream that somebody has closed raises ``ValueError``.
        except (OSError, ValueError):
            self.lost += bool(text.strip())
        return len(text)

    def flush(self) -> None:
        """What cannot be flushed stays for the next line."""
        with suppress(OSError, ValueError):
            self._stream.flush()

    def isatty(self) -> bool:
        """As the stream below."""
        return self._stream.isatty()


def configure(
    *, level: LogLevel = LogLevel.INFO, beside: bool = False, stream: LineStream | None = None
) -> None:
    """Set up logging for this process; call once, first.

    Drivers and libraries log by the standard library; their lines look like all others. With
    ``beside`` a thread writes them, so that nobody who logs waits for the disk. ``stream`` takes
    whole lines; without one they go to standard error.
    """
    for name in QUIET_LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    # Its errors are what nobody else tells of: a task that failed and was held by nobody, a
    # callback that raised. Its warnings are noise, such as each write to a link that is known to be
    # lost.
    logging.getLogger("asyncio").setLevel(logging.ERROR)
    unfailing = UnfailingStream(sys.stderr if stream is None else stream)
    lines = cast(TextIO, _by_thread(unfailing) if beside else unfailing)
    before: list[Processor] = [
        _add_facts,
        structlog.processors.add_log_level,
        structlog.processors.TimeStamper(fmt="iso", utc=True),
    ]
    after: list[Processor] = [structlog.processors.format_exc_info, _renderer()]
    structlog.configure(
        processors=[*before, *after],
        wrapper_class=structlog.make_filtering_bound_logger(getattr(logging, level)),
        logger_factory=structlog.WriteLoggerFactory(lines),
        # Loggers are made at import, before this function runs. One that was used by then would
        # otherwise keep the old set-up.
        cache_logger_on_first_use=False,
    )
    handler = logging.StreamHandler(lines)
    handler.setFormatter(
        ProcessorFormatter(
            foreign_pre_chain=[*before, _add_module],
            processors=[ProcessorFormatter.remove_processors_meta, *after],
        )
    )
    logging.basicConfig(level=level, handlers=[handler], force=True)


def _by_thread(stream: UnfailingStream) -> LogThread:
    thread = LogThread(stream)
    atexit.register(thread.close)
    return thread


def _renderer() -> Processor:
    if sys.stderr.isatty():
        return structlog.dev.ConsoleRenderer()
    return structlog.processors.JSONRenderer()


def _add_module(_: WrappedLogger, __: str, event: EventDict) -> EventDict:
    event["module"] = event["_record"].name
    return event


def get(name: str) -> structlog.typing.FilteringBoundLogger:
    """A logger that names its module."""
    logger: structlog.typing.FilteringBoundLogger = structlog.get_logger(module=name)
    return logger


def always(facts: Facts) -> None:
    """Have every line say these, too, whoever logs it; ``always(dict)`` ends that.

    ``facts`` is asked for each line, by any thread, and must not wait. What a line says itself
    goes first. Fields that are bound to a task would not do: guards, drivers and the line log in
    tasks and threads of their own.
    """
    _said.facts = facts


def _add_facts(_: WrappedLogger, __: str, event: EventDict) -> EventDict:
    for name, value in _said.facts().items():
        event.setdefault(name, value)
    return event
