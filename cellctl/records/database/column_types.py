"""Column types of the run store: UTC times, and values that SQLite keeps as JSON."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import JSON, DateTime, Dialect
from sqlalchemy.types import TypeDecorator

from cellctl.records.entries import PassComponent


class Utc(TypeDecorator[datetime]):
    """Aware UTC in Python, naive in SQLite, which knows no time zones."""

    impl = DateTime
    cache_ok = True

    def process_bind_param(self, value: datetime | None, _dialect: Dialect) -> datetime | None:
        """Convert a value of Python to what the database keeps."""
        # Converted before the zone is dropped: a local time would otherwise be stored as if it were
        # UTC.
        return None if value is None else value.astimezone(UTC).replace(tzinfo=None)

    def process_result_value(self, value: datetime | None, _dialect: Dialect) -> datetime | None:
        """Convert what the database keeps to a value of Python."""
        return None if value is None else value.replace(tzinfo=UTC)


class PlainJson(TypeDecorator[Any]):
    """Numbers, texts, sequences and mappings; sequences come back as tuples.

    The entries of the store are frozen, so what they hold must not change either: hence tuples.
    """

    # A None must become SQL NULL, not the text "null", so that it reads as unknown in any tool.
    impl = JSON(none_as_null=True)
    cache_ok = True

    def process_bind_param(self, value: Any, _dialect: Dialect) -> Any:
        """Convert a value of Python to what the database keeps."""
        return plain(value)

    def process_result_value(self, value: Any, _dialect: Dialect) -> Any:
        """Convert what the database keeps to a value of Python."""
        return _frozen(value)


class PassComponents(TypeDecorator[tuple[PassComponent, ...]]):
    """The components of one pass of a loop."""

    impl = JSON
    cache_ok = True

    def process_bind_param(
        self, value: Sequence[PassComponent] | None, _dialect: Dialect
    ) -> list[Any]:
        """Convert a value of Python to what the database keeps."""
        return [plain(asdict(component)) for component in value or ()]

    def process_result_value(self, value: Any, _dialect: Dialect) -> tuple[PassComponent, ...]:
        """Convert what the database keeps to a value of Python."""
        return tuple(PassComponent(**component) for component in value)


def plain(value: Any) -> Any:
    """A value as JSON can hold it; a number that is not finite becomes None."""
    if isinstance(value, float):
        # JSON has no NaN and no infinity; Python would write them and nobody else could read it.
        return float(value) if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return value


def _frozen(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_frozen(entry) for entry in value)
    if isinstance(value, dict):
        return {key: _frozen(entry) for key, entry in value.items()}
    return value
