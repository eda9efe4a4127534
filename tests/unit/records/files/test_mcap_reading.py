"""Files that are damaged, or made by somebody else, end in a fault with a number."""

import contextlib
import io
import json
import struct

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mcap.writer import CompressionType, Writer

from cellctl.errors.records.store import RecordingUnreadable
from cellctl.records.files.curve_file import read_recording
from cellctl.records.files.mcap_reading import read_mcap, read_raw

GOOD = json.dumps({"time_s": 1.0, "travel_mm": 2.0, "fx_n": 3.0}).encode()


def recording(*payloads: bytes) -> bytes:
    """A recording without checksums, as some write it: damage then gets as far as it can."""
    file = io.BytesIO()
    writer = Writer(file, compression=CompressionType.NONE, enable_crcs=False)
    writer.start()
    schema = writer.register_schema("a.Sample", "jsonschema", b"{}")
    channel = writer.register_channel("/a", "json", schema)
    for number, payload in enumerate(payloads):
        writer.add_message(channel, number, payload, number)
    writer.finish()
    return file.getvalue()


@pytest.mark.parametrize("nested", [b"[", b'{"a":'])
def test_a_message_nested_without_end_is_damage(nested: bytes) -> None:
    content = read_mcap(recording(GOOD, nested * 100_000))
    assert [one.values for one in content.messages] == [json.loads(GOOD)]
    assert not content.complete
    with pytest.raises(RecordingUnreadable):
        read_mcap(recording(nested * 100_000))


@pytest.mark.parametrize(
    "payload",
    [
        b"3",
        b"null",
        b'{"time_s": "soon"}',
        b'{"time_s": [1]}',
        b'{"time_s": true}',
        b'{"time_s": 1' + b"0" * 400 + b"}",
    ],
)
def test_a_curve_ends_before_the_first_message_that_is_no_sample(payload: bytes) -> None:
    found = read_recording(recording(GOOD, payload, GOOD))
    assert found.curve.time_s.tolist() == [1.0]
    assert not found.complete
    with pytest.raises(RecordingUnreadable):
        read_recording(recording(payload))


_WHOLE = recording(*[GOOD] * 20)
_LENGTH_AT = _WHOLE.index(GOOD) - 30
"""Place of the first message's length: eight bytes after its opcode, before 22 bytes and text."""


@given(st.integers(0, len(_WHOLE) - 8), st.binary(min_size=1, max_size=8))
@example(_LENGTH_AT, struct.pack("<Q", 2**64 - 1))
def test_damaged_bytes_are_a_clear_fault_at_worst(at: int, bytes_there: bytes) -> None:
    damaged = _WHOLE[:at] + bytes_there + _WHOLE[at + len(bytes_there) :]
    for read in (read_raw, read_mcap, read_recording):
        with contextlib.suppress(RecordingUnreadable):
            read(damaged)
