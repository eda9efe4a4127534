"""Reads MCAP files of JSON messages as far as they are readable."""

import io
import json
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from mcap.exceptions import McapError
from mcap.records import Channel, McapRecord, Message, Metadata
from mcap.stream_reader import StreamReader
from zstandard import ZstdError

from cellctl.errors.records.store import RecordingUnreadable

MEDIA_TYPE = "application/x-mcap"
_RECORD_LIMIT = 16 * 1024 * 1024
"""Keeps a damaged length from asking for all of the memory."""
_DAMAGE = (
    McapError, ZstdError, ValueError, KeyError, EOFError, struct.error, OverflowError, MemoryError,
)  # fmt: skip
"""Whatever a cut off or damaged file raises in its middle: what was read before that is good, each
chunk has a checksum of its own. The last two come from lengths that no file could have."""


@dataclass(frozen=True, slots=True)
class RecordedMessage:
    """One message of a recording."""

    topic: str
    values: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class RawMessage:
    """One message as its bytes."""

    topic: str
    time_ns: int
    """Wall-clock time since 1970, UTC."""
    data: bytes


@dataclass(frozen=True, slots=True)
class RawContent:
    """What could be read of a file, its messages as they lie there."""

    messages: tuple[RawMessage, ...]
    facts: Mapping[str, str]
    """Its newest metadata."""
    complete: bool
    """False when the file was cut off or is damaged; the messages then end early."""


@dataclass(frozen=True, slots=True)
class McapContent:
    """What could be read of a file."""

    messages: tuple[RecordedMessage, ...]
    facts: Mapping[str, str]
    """Its newest metadata."""
    complete: bool
    """False when the file was cut off or is damaged; the messages then end early."""


def read_mcap(data: bytes) -> McapContent:
    """Everything up to the first damage; ``RecordingUnreadable`` when no message lies before it."""
    raw = read_raw(data)
    messages: list[RecordedMessage] = []
    complete = raw.complete
    try:
        for one in raw.messages:
            messages.append(RecordedMessage(one.topic, json.loads(one.data)))
    except (ValueError, RecursionError) as error:
        # Brackets within brackets without end use up Python's stack.
        complete = False
        if not messages:
            raise RecordingUnreadable(str(error)) from error
    return McapContent(tuple(messages), raw.facts, complete)


def read_raw(data: bytes) -> RawContent:
    """What ``read_mcap`` reads, but without decoding the messages."""
    topics: dict[int, str] = {}
    messages: list[RawMessage] = []
    facts: dict[str, str] = {}
    complete = True
    try:
        for record in _records(data):
            if isinstance(record, Channel):
                topics[record.id] = record.topic
            elif isinstance(record, Message):
                topic = topics[record.channel_id]
                messages.append(RawMessage(topic, record.log_time, record.data))
            elif isinstance(record, Metadata):
                facts = dict(record.metadata)
    except _DAMAGE as error:
        complete = False
        if not messages:
            raise RecordingUnreadable(str(error) or type(error).__name__) from error
    return RawContent(tuple(messages), facts, complete)


def has_messages(data: bytes) -> bool:
    """True when at least one message can be read; looks no further than to the first."""
    try:
        return any(isinstance(record, Message) for record in _records(data))
    except _DAMAGE:
        return False


def _records(data: bytes) -> Iterator[McapRecord]:
    """All records in their order; raises ``_DAMAGE`` where the file cannot be read on."""
    reader = StreamReader(io.BytesIO(data), validate_crcs=True, record_size_limit=_RECORD_LIMIT)
    yield from reader.records
