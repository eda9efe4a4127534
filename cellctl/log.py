"""Structured logs: for people on a terminal, JSON otherwise; run and step on every line."""

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import structlog

QUIET_LOGGERS = ("pymodbus.logging", "asyncio", "can", "transitions.core", "transitions")


def configure(*, level: str = "INFO") -> None:
    """Set up logging for this process; call once, first."""
    for name in QUIET_LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    renderer: structlog.typing.Processor = (
        structlog.dev.ConsoleRenderer()
        if sys.stderr.isatty()
        else structlog.processors.JSONRenderer()
    )
    structlog.configure(
        processors=[
            structlog.contextvars.merge_contextvars,
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(fmt="iso", utc=True),
            structlog.processors.format_exc_info,
            renderer,
        ],
        wrapper_class=structlog.make_filtering_bound_logger(getattr(logging, level)),
        logger_factory=structlog.PrintLoggerFactory(sys.stderr),
        cache_logger_on_first_use=False,
    )


def get(name: str) -> structlog.typing.FilteringBoundLogger:
    """A logger that names its module."""
    logger: structlog.typing.FilteringBoundLogger = structlog.get_logger(module=name)
    return logger


@contextmanager
def bound(**fields: object) -> Iterator[None]:
    """Add fields (run, step, …) to every line logged inside, across awaits of this task."""
    with structlog.contextvars.bound_contextvars(**fields):
        yield
