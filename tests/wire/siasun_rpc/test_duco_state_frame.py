"""Frames of the state stream: offsets, pieces, and bytes that are none."""

import contextlib
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun_rpc.codec.state_frame import FRAME_BYTES, FrameReader, parse


def frame(**changes: bytes) -> bytes:
    """A frame by docs/protocols/siasun-rpc.md, section 5; keys are ``at_<offset>``."""
    data = bytearray(1468)
    struct.pack_into("<7f", data, 0, 0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.0)
    struct.pack_into("<6f", data, 368, 0.4, -0.1, 0.6, 3.0, 0.0, 1.0)
    data[660] = 55
    data[1448:1454] = bytes([2, 6, 0, 5, 0, 0])
    for place, value in changes.items():
        at = int(place.removeprefix("at_"))
        data[at : at + len(value)] = value
    return bytes(data)


def test_offsets() -> None:
    told = parse(frame(at_1407=b"\1", at_1452=b"\1\4", at_1456=struct.pack("<I", 70_001)))
    assert told.joints_rad == pytest.approx((0.1, -0.2, 0.3, -0.4, 0.5, -0.6))
    assert (told.mode, told.power, told.program, told.safety) == (2, 6, 0, 5)
    assert told.override_percent == 55
    assert told.simulated
    assert (told.collision, told.collision_axis) == (True, 4)
    assert told.error == 70_001


@pytest.mark.parametrize(
    "changes",
    [
        {"at_0": struct.pack("<f", 13.0)},
        {"at_20": struct.pack("<f", float("nan"))},
        {"at_368": struct.pack("<f", -11.0)},
        {"at_376": struct.pack("<f", float("inf"))},
        {"at_660": b"\x65"},
        {"at_1407": b"\2"},
        {"at_1452": b"\2"},
    ],
    ids=str,
)
def test_impossible_frames_are_refused(changes: dict[str, bytes]) -> None:
    with pytest.raises(ProtocolViolation):
        parse(frame(**changes))


@given(st.lists(st.integers(1, 900), min_size=1, max_size=12))
def test_frames_are_found_however_they_are_cut(sizes: list[int]) -> None:
    stream, reader, found = frame() * 3, FrameReader(), 0
    for size in [*sizes, len(stream)]:
        reader.feed(stream[:size])
        stream = stream[size:]
        while reader.next() is not None:
            found += 1
    assert found == 3


@given(st.integers(0, FRAME_BYTES - 1), st.binary(min_size=1, max_size=64))
def test_any_bytes_in_a_frame(at: int, data: bytes) -> None:
    damaged = frame()[:at] + data
    with contextlib.suppress(ProtocolViolation):
        parse((damaged + bytes(FRAME_BYTES))[:FRAME_BYTES])
