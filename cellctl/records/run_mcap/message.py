"""What the parts of a recording are made of before they are written in the order of time."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any, TypeAlias

from google.protobuf.message import Message
from google.protobuf.timestamp_pb2 import Timestamp


@dataclass(frozen=True, slots=True)
class JsonValues:
    """A JSON message of one of the schemas of ``json_schemas``."""

    schema: str
    values: Mapping[str, Any]
    """No number is NaN; a value that is missing is None."""


@dataclass(frozen=True, slots=True)
class RecordedJson:
    """A JSON message as the run has recorded it."""

    schema: str
    data: bytes


Content: TypeAlias = Message | JsonValues | RecordedJson


@dataclass(frozen=True, slots=True)
class TimedMessage:
    """One message of the file."""

    time_ns: int
    """Wall-clock time since 1970, UTC."""
    topic: str
    content: Content | Callable[[], Content | None]
    """A function is called when the message is written: an image is five megabytes, and a run has
    forty. It may find that there is none."""


def nanoseconds(time: datetime) -> int:
    """A wall-clock time in nanoseconds; exact to the microsecond that it has."""
    return int(time.timestamp()) * 1_000_000_000 + time.microsecond * 1000


def stamp(time_ns: int) -> Timestamp:
    """A time in nanoseconds as messages hold it."""
    return Timestamp(seconds=time_ns // 1_000_000_000, nanos=time_ns % 1_000_000_000)
