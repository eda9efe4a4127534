"""Writes equal contents as equal text, so that their hashes can be compared years later."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from datetime import datetime
from typing import Any


def columns(row: Any) -> dict[str, Any]:
    """All columns of a row by their names."""
    # Of the table and not of the object: SQLAlchemy keeps state of its own in the instance.
    return {column.key: getattr(row, column.key) for column in row.__table__.columns}


def digest(document: Mapping[str, Any]) -> str:
    """SHA-256 of a document, whatever the order of its keys.

    The form must never change: every seal of every store was made with it. Sequences are written
    as JSON lists, times in ISO 8601, dataclasses as their fields.
    """
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()


def _plain(value: Any) -> Any:
    if isinstance(value, datetime):
        return value.isoformat()
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    raise TypeError(f"{type(value).__name__} has no canonical form")
