import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.ftsensor.sri.protocol import (
    DataFormat,
    Frame,
    FrameLayout,
    Reply,
    StreamDecoder,
    command,
    parse_format,
    parse_matrix,
    parse_six,
)
from tests.unit.drivers.ftsensor.sri.frames import GOLDEN, GOLDEN_CRC, frame

PLAIN = FrameLayout()


def decode(data: bytes, layout: FrameLayout = PLAIN) -> list[Reply | Frame]:
    return StreamDecoder(layout).feed(data)


@pytest.mark.parametrize("number", GOLDEN)
def test_golden_frames(number: int) -> None:
    text, printed = GOLDEN[number]
    (found,) = decode(bytes.fromhex(text))
    assert isinstance(found, Frame)
    assert found.number == number
    assert found.points[0] == pytest.approx(printed, rel=1e-3, abs=5e-7)


def test_golden_frame_with_crc() -> None:
    (found,) = decode(GOLDEN_CRC, FrameLayout(check="CRC32"))
    assert isinstance(found, Frame)
    assert found.number == 50375
    assert found.points[0] == pytest.approx(GOLDEN[50375][1], rel=1e-3)


def test_the_other_crc_is_another_check() -> None:
    layout = FrameLayout(check="CRC32", crc="mpeg2")
    assert decode(GOLDEN_CRC, layout) == []
    assert layout.checker(b"123456789") == (0x0376E6E7).to_bytes(4, "little")


@pytest.mark.parametrize(
    ("layout", "total"),
    [
        (FrameLayout(), 31),
        (FrameLayout(check="CRC32"), 34),
        (FrameLayout(unit="C"), 19),
        (FrameLayout(points=10), 247),
        (FrameLayout(unit="C", points=10), 127),
    ],
)
def test_lengths_of_the_manual(layout: FrameLayout, total: int) -> None:
    assert layout.total_bytes == total


def test_counts_are_big_endian() -> None:
    data = struct.pack(">6H", 1, 256, 32768, 65535, 0, 7)
    raw = b"\xaa\x55\x00\x0f\x00\x05" + data + bytes([sum(data) % 256])
    assert decode(raw, FrameLayout(unit="C")) == [Frame(5, ((1, 256, 32768, 65535, 0, 7),))]


def test_points_are_sample_major() -> None:
    data = struct.pack("<12f", *range(12))
    raw = b"\xaa\x55\x00\x33\x00\x05" + data + bytes([sum(data) % 256])
    (found,) = decode(raw, FrameLayout(points=2))
    assert found == Frame(5, (tuple(map(float, range(6))), tuple(map(float, range(6, 12)))))


@pytest.mark.parametrize(
    ("line", "reply"),
    [
        (b"ACK+ETPT=4008$OK\r\n", Reply("ETPT", "4008", ok=True)),
        (b"ACK+DCKMD=SUM$OK\r\n", Reply("DCKMD", "SUM", ok=True)),
        (b"ACK+GSD=STOP$OK\r\n", Reply("GSD", "STOP", ok=True)),
        (b"ACK+SMPF=$ERROR\r\n", Reply("SMPF", "", ok=False)),
        (b"ACK+SMPF=ERROR!\r\n", Reply("SMPF", "", ok=False)),
    ],
)
def test_replies(line: bytes, reply: Reply) -> None:
    assert decode(line) == [reply]


def test_commands() -> None:
    assert command("GSD") == b"AT+GSD\r\n"
    assert command("SMPF", "?") == b"AT+SMPF=?\r\n"


def test_a_reply_between_frames_and_a_cut_tail() -> None:
    decoder = StreamDecoder(FrameLayout())
    stream = frame(1) + b"ACK+SMPF=200$OK\r\n" + frame(2) + frame(3)[:9]
    kinds = [type(item) for item in decoder.feed(stream)]
    assert kinds == [Frame, Reply, Frame]
    (last,) = decoder.feed(frame(3)[9:])
    assert isinstance(last, Frame)
    assert last.number == 3
    assert (decoder.skipped_bytes, decoder.checksum_errors) == (0, 0)


def test_a_doubled_first_byte_is_no_loss() -> None:
    decoder = StreamDecoder(FrameLayout())
    assert len(decoder.feed(b"\xaa" + frame(1))) == 1
    assert decoder.skipped_bytes == 1


def test_a_false_header_inside_a_damaged_frame_costs_one_frame() -> None:
    inner = struct.unpack("<f", b"\xaa\x55\x00\x1b")[0]
    damaged = bytearray(frame(1, 1.0, 2.0, inner, 4.0, 5.0, 6.0))
    damaged[-1] ^= 1
    decoder = StreamDecoder(FrameLayout())
    found = decoder.feed(bytes(damaged) + frame(2) + frame(3))
    assert [item.number for item in found if isinstance(item, Frame)] == [2, 3]
    assert decoder.checksum_errors >= 1


def test_a_frame_of_another_format_is_refused() -> None:
    assert decode(frame(1), FrameLayout(unit="C")) == []


def test_ack_in_garbage_does_not_block_the_stream() -> None:
    decoder = StreamDecoder(FrameLayout())
    found = decoder.feed(b"ACK+\x00" + frame(1))
    assert [type(item) for item in found] == [Frame]


@given(st.binary(max_size=400))
def test_fuzz_any_bytes_then_frames(garbage: bytes) -> None:
    """After whatever noise the decoder is back in step within two frames."""
    decoder = StreamDecoder(FrameLayout())
    found = decoder.feed(garbage)
    for number in range(60):
        found = decoder.feed(frame(number))
    assert [item.number for item in found if isinstance(item, Frame)] == [59]


@given(st.lists(st.integers(1, 40), min_size=1, max_size=60), st.binary(max_size=20))
def test_fuzz_chunks_do_not_matter(cuts: list[int], noise: bytes) -> None:
    stream = noise + b"".join(frame(n) + b"ACK+SMPF=1$OK\r\n" * (n % 3 == 0) for n in range(20))
    whole = decode(stream)
    decoder = StreamDecoder(FrameLayout())
    pieces: list[Reply | Frame] = []
    at = 0
    for cut in [*cuts, len(stream)]:
        pieces += decoder.feed(stream[at : at + cut])
        at += cut
    assert pieces == whole


@given(st.integers(0, 30), st.integers(0, 7))
def test_fuzz_one_flipped_bit_never_becomes_a_sample(position: int, bit: int) -> None:
    flipped = bytearray(frame(7))
    flipped[position] ^= 1 << bit
    found = decode(bytes(flipped))
    numbers = {item.number for item in found if isinstance(item, Frame)}
    # The check does not cover the number: a flip there is a gap, not a wrong value.
    assert not found or (position in (4, 5) and 7 not in numbers)


def test_values_of_replies() -> None:
    text = "(A01,A02,A03,A04,A05,A06);C;1;(WMA:1.000000)"
    assert parse_format(text) == DataFormat(
        ("A01", "A02", "A03", "A04", "A05", "A06"), "C", 1, (1.0,)
    )
    assert parse_six("1;2;3;4;5;6") == (1, 2, 3, 4, 5, 6)
    rows = parse_matrix(";".join("(1,2,3,4,5,6)" for _ in range(6)))
    assert rows == ((1, 2, 3, 4, 5, 6),) * 6


@pytest.mark.parametrize(
    ("parse", "text"),
    [(parse_format, "rubbish"), (parse_six, "1;2"), (parse_matrix, "(1,2,3,4,5,6)")],
)
def test_wrong_values_of_replies(parse: object, text: str) -> None:
    with pytest.raises(ValueError, match=r".+"):
        parse(text)  # type: ignore[operator]
