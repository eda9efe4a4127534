"""Reads an exported run with the official reader."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

_TYPES = {
    "string": str, "number": (int, float), "integer": int, "boolean": bool, "array": list,
    "object": dict, "null": type(None),
}  # fmt: skip


@dataclass
class Content:
    """Everything that a file holds."""

    messages: list[tuple[str, int, Any]] = field(default_factory=list)
    schemas: dict[str, str] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)

    def of(self, topic: str) -> list[Any]:
        """Messages of a topic."""
        return [message for name, _, message in self.messages if name == topic]


def read(path: Path) -> Content:
    """Decoded by the official reader, checksums and JSON schemas checked."""
    content = Content()
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None
            content.schemas[channel.topic] = schema.name
            if channel.message_encoding == "json":
                values = json.loads(message.data)
                require_valid(values, json.loads(schema.data), channel.topic)
            else:
                decode = DecoderFactory().decoder_for(channel.message_encoding, schema)
                assert decode is not None
                values = decode(message.data)
            content.messages.append((channel.topic, message.log_time, values))
        content.metadata = {one.name: dict(one.metadata) for one in reader.iter_metadata()}
        content.attachments = {one.name: one.data for one in reader.iter_attachments()}
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.message_count == len(content.messages)
    return content


def require_valid(values: dict[str, Any], schema: dict[str, Any], topic: str) -> None:
    """What the schemas say is types; registers have the names of the register map."""
    for name, value in values.items():
        if name not in schema["properties"]:
            assert topic.startswith("/registers/"), (topic, name)
            continue
        kinds = schema["properties"][name]["type"]
        kinds = [kinds] if isinstance(kinds, str) else kinds
        assert isinstance(value, tuple(_flat(_TYPES[kind] for kind in kinds))), (topic, name, value)


def _flat(kinds: Any) -> list[type]:
    return [one for kind in kinds for one in (kind if isinstance(kind, tuple) else (kind,))]
