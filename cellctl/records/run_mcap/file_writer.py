"""Writes messages into an MCAP file: schemas once, channels once, checksums everywhere."""

import json
from collections import Counter
from datetime import datetime
from typing import IO

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from google.protobuf.message import Message
from mcap.writer import CompressionType, Writer
from mcap_protobuf.schema import register_schema

from cellctl.records.run_mcap.json_schemas import json_schema
from cellctl.records.run_mcap.message import Content, JsonValues, TimedMessage, nanoseconds

_CHUNK_BYTES = 1024 * 1024
"""A viewer reads whole chunks: small ones, so that a look at the forces reads few images."""


class RunFileWriter:
    """Belongs to one thread. Every method raises what the stream raises, ``OSError``."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._writer = Writer(stream, chunk_size=_CHUNK_BYTES, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library="cellctl")
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self.written: Counter[str] = Counter()
        """Messages by topic."""
        self.frames: set[str] = set()
        """Names of the frames of all transforms so far."""

    def add(self, message: TimedMessage) -> None:
        """Messages come in the order of their times."""
        content = message.content() if callable(message.content) else message.content
        if content is None:
            return
        if isinstance(content, FrameTransforms):
            for one in content.transforms:
                self.frames |= {one.parent_frame_id, one.child_frame_id}
        if message.topic not in self._channels:
            self._channels[message.topic] = self._channel(message.topic, content)
        self._writer.add_message(
            self._channels[message.topic],
            message.time_ns,
            _encoded(content),
            message.time_ns,
            self.written[message.topic],
        )
        self.written[message.topic] += 1

    def metadata(self, name: str, values: dict[str, str]) -> None:
        """Texts about the whole file."""
        self._writer.add_metadata(name, values)

    def attach(self, name: str, time: datetime, media_type: str, data: bytes) -> None:
        """A file inside of the file."""
        time_ns = nanoseconds(time)
        self._writer.add_attachment(time_ns, time_ns, name, media_type, data)

    def finish(self) -> None:
        """Write summary and checksum; nothing may be added afterwards."""
        self._writer.finish()

    def _channel(self, topic: str, content: Content) -> int:
        if isinstance(content, Message):
            name = content.DESCRIPTOR.full_name
            if name not in self._schemas:
                self._schemas[name] = register_schema(self._writer, type(content))
            return int(self._writer.register_channel(topic, "protobuf", self._schemas[name]))
        if content.schema not in self._schemas:
            schema = json.dumps(json_schema(content.schema)).encode()
            self._schemas[content.schema] = self._writer.register_schema(
                content.schema, "jsonschema", schema
            )
        return int(self._writer.register_channel(topic, "json", self._schemas[content.schema]))


def _encoded(content: Content) -> bytes:
    if isinstance(content, Message):
        return content.SerializeToString()
    if isinstance(content, JsonValues):
        # NaN would be no JSON, and viewers refuse the whole message.
        return json.dumps(content.values, allow_nan=False).encode()
    return content.data
