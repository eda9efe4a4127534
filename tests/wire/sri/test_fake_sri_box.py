"""The fake box spoken to with literal bytes; golden frames are from public sources."""

import struct

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fakes.wire.sri.box import SriBox
from fakes.wire.sri.core import SriCore
from fakes.wire.sri.frames import build_frame, pack_floats
from fakes.wire.sri.session import SriSession

WRENCH = (10.0, -20.0, -1962.0, 1.5, -2.5, 0.25)

GOLDEN = {
    # number: frame as hex, printed values
    50375: (
        "AA55001BC4C7016AF4C0EF7D33C04962C9C0A25CC6BDA6198FBDAFDA693E6E",
        (-7.637940, -2.804561, -6.293248, -0.096856, -0.069873, 0.228373),
    ),
    53739: (
        "AA55001BD1EB41A3A43ECAD1B43F3606 12BE6A6F833B240256BB00EA3C378B",
        (0.321558, 1.412652, -0.142602, 0.004011, -0.003266, 1.126e-05),
    ),
    0: (
        "AA55001B0000C148F2C171712FC29DE194C178A96BC17057E5C19B8CE3C1E7",
        (-30.285524, -43.860783, -18.610163, -14.728874, -28.667694, -28.443655),
    ),
}


def start(**faults: float) -> SriSession:
    """A session at rate 100 Hz whose stream began at time 0."""
    core = SriCore(lambda time_s: WRENCH)
    for name, value in faults.items():
        core.faults.inject(name, value)
    session = SriSession(core)
    assert session.receive(b"AT+SMPF=100\r\nAT+GSD\r\n", 0.0).endswith(b"\r\n")
    return session


def run(session: SriSession, frames: int) -> list[bytes]:
    """Writes of the next so many periods."""
    assert session.due_s is not None
    first_s = session.due_s
    return [w for k in range(frames) for w in session.emit(first_s + k * 0.01 + 1e-9)]


@pytest.mark.parametrize("number", GOLDEN)
def test_golden_frames(number: int) -> None:
    text, printed = GOLDEN[number]
    golden = bytes.fromhex(text)
    values = struct.unpack("<6f", golden[6:30])
    assert values == pytest.approx(printed, rel=1e-3, abs=5e-7)
    assert build_frame(number, pack_floats([values])) == golden


def test_golden_crc_frame() -> None:
    data = bytes.fromhex(GOLDEN[50375][0])[6:30]
    frame = build_frame(50375, data, "CRC32")
    assert frame[:6] == bytes.fromhex("AA55001EC4C7")
    assert frame[-4:] == bytes.fromhex("48FF42C4")
    assert len(frame) == 34


@pytest.mark.parametrize(
    ("command", "reply"),
    [
        (b"AT+ETPT=?\r\n", b"ACK+ETPT=4008$OK\r\n"),
        (b"AT+ETPT=4009\r\n", b"ACK+ETPT=4009$OK\r\n"),
        (b"AT+DCKMD=SUM\r\n", b"ACK+DCKMD=SUM$OK\r\n"),
        (b"AT+DCKMD=MD5\r\n", b"ACK+DCKMD=$ERROR\r\n"),
        (b"AT+NOSUCH=?\r\n", b"ACK+NOSUCH=$ERROR\r\n"),
        (b"AT+SMPF=99999\r\n", b"ACK+SMPF=$ERROR\r\n"),
        (b"AT+DCPCU=MV\r\n", b"ACK+DCPCU=MV$OK\r\n"),
        (b"AT+GSD=STOP\r\n", b"ACK+GSD=STOP$OK\r\n"),
        (
            b"AT+SGDM=(A01,A02,A03,A04,A05,A06);C;1;(WMA:1)\r\n",
            b"ACK+SGDM=(A01,A02,A03,A04,A05,A06);C;1;(WMA:1.000000)$OK\r\n",
        ),
        (b"AT+SGDM=(A07);E;1;(WMA:1)\r\n", b"ACK+SGDM=$ERROR\r\n"),
        (b"hello\r\n", b""),
    ],
)
def test_replies(command: bytes, reply: bytes) -> None:
    session = SriSession(SriCore(lambda time_s: WRENCH))
    assert b"".join(session.receive(bytes([b]), 0.0) for b in command) == reply


def test_per_channel_reply_has_six_decimals() -> None:
    session = SriSession(SriCore(lambda time_s: WRENCH))
    reply = session.receive(b"AT+CHNAPG=?\r\n", 0.0)
    assert reply.startswith(b"ACK+CHNAPG=123.691486;123.702110;")


@pytest.mark.parametrize(
    ("data_format", "check", "length"),
    [("E;1", "SUM", 31), ("E;1", "CRC32", 34), ("C;1", "SUM", 19), ("E;10", "SUM", 247)],
)
def test_single_package(data_format: str, check: str, length: int) -> None:
    session = SriSession(SriCore(lambda time_s: WRENCH))
    session.receive(f"AT+DCKMD={check}\r\n".encode(), 0.0)
    session.receive(f"AT+SGDM=(A01,A02,A03,A04,A05,A06);{data_format}\r\n".encode(), 0.0)
    frame = session.receive(b"AT+GOD=\r\n", 1.0)
    assert len(frame) == length
    assert frame[:2] == b"\xaa\x55"
    assert int.from_bytes(frame[2:4], "big") == length - 4
    if data_format[0] == "E":
        assert struct.unpack_from("<6f", frame, 6) == pytest.approx(WRENCH, rel=1e-6)


def test_counts_convert_back_with_the_published_formula() -> None:
    session = SriSession(SriCore(lambda time_s: WRENCH))

    def query(name: str) -> list[float]:
        reply = session.receive(f"AT+{name}=?\r\n".encode(), 0.0).decode()
        return [float(v) for v in reply.removesuffix("$OK\r\n").split("=")[1].split(";")]

    matrix_text = session.receive(b"AT+DCPM=?\r\n", 0.0).decode().split("=")[1]
    rows = [r.strip("()") for r in matrix_text.removesuffix("$OK\r\n").split(";")]
    matrix = [[float(v) for v in row.split(",")] for row in rows]
    frame = session.receive(b"AT+GOD=(A01,A02,A03,A04,A05,A06);C;1\r\n", 1.0)
    counts = struct.unpack(">6H", frame[6:18])
    zero, gain, excitation = query("AMPZ"), query("CHNAPG"), query("EXMV")
    bridge = [
        1000 * (c - z) / 65535 * 5 / g / e
        for c, z, g, e in zip(counts, zero, gain, excitation, strict=True)
    ]
    wrench = [sum(m * x for m, x in zip(row, bridge, strict=True)) for row in matrix]
    assert wrench == pytest.approx(WRENCH, abs=0.5)


def test_a_wrong_matrix_gives_wrong_values() -> None:
    session = SriSession(SriCore(lambda time_s: WRENCH))
    rows = ";".join(f"({','.join('1' if r == c else '0' for c in range(6))})" for r in range(6))
    assert b"$OK" in session.receive(f"AT+DCPM={rows}\r\n".encode(), 0.0)
    values = struct.unpack_from("<6f", session.receive(b"AT+GOD\r\n", 1.0), 6)
    assert values[2] == pytest.approx(-0.98, abs=0.05)


@given(st.text("AT+SGDMPFOECKWU0123456789=?()$;:,.-\r\n", max_size=80))
@example("SGDM=(A01);E;1;(WMA:1,0)\r\nAT+GOD\r\n")
@example("DCPM=(1);(2);(3);(4);(5);(6)\r\n")
@example("SMPF=nan\r\nAT+ADJZF\r\n")
def test_no_text_upsets_the_box(text: str) -> None:
    session = SriSession(SriCore(lambda time_s: WRENCH))
    session.receive(b"AT+" + text.encode() + b"\r\n", 0.0)
    assert session.receive(b"AT+ETPT=4010\r\n", 1.0) == b"ACK+ETPT=4010$OK\r\n"


def test_stream_has_the_sample_of_each_due_time() -> None:
    core = SriCore(lambda time_s: (time_s, 0.0, 0.0, 0.0, 0.0, 0.0))
    session = SriSession(core)
    session.receive(b"AT+SMPF=500\r\nAT+GSD\r\n", 10.0)
    frames = session.emit(10.010 + 1e-9)
    times = [struct.unpack_from("<f", frame, 6)[0] for frame in frames]
    assert times == pytest.approx([10.002, 10.004, 10.006, 10.008, 10.010])
    assert [int.from_bytes(f[4:6], "big") for f in frames] == [0, 1, 2, 3, 4]


def test_number_wraps() -> None:
    session = start()
    session._core.next_number = 65535
    numbers = [int.from_bytes(frame[4:6], "big") for frame in run(session, 3)]
    assert numbers == [65535, 0, 1]


def test_a_slow_line_saturates() -> None:
    session = SriSession(SriCore(lambda time_s: WRENCH), max_bytes_per_s=11520)
    session.receive(b"AT+SMPF=1000\r\nAT+GSD\r\n", 0.0)
    assert len(session.emit(1.0)) == 371


def test_stop_is_acknowledged_and_ends_the_stream() -> None:
    session = start()
    run(session, 2)
    assert session.receive(b"AT+GSD=STOP\r\n", 0.5) == b"ACK+GSD=STOP$OK\r\n"
    assert session.due_s is None
    assert session.emit(100.0) == []


def test_weighted_mean_filter() -> None:
    core = SriCore(lambda time_s: (time_s, 0.0, 0.0, 0.0, 0.0, 0.0))
    session = SriSession(core)
    session.receive(b"AT+SMPF=1\r\nAT+SGDM=(A01,A02,A03,A04,A05,A06);E;1;(WMA:1,3)\r\n", 0.0)
    session.receive(b"AT+GSD\r\n", 0.0)
    frames = [session.emit(t + 1e-9)[0] for t in (1.0, 2.0)]
    assert struct.unpack_from("<f", frames[1], 6)[0] == pytest.approx((1.0 + 3 * 2.0) / 4)


class TestFaults:
    def test_split_loses_no_byte(self) -> None:
        healthy = b"".join(run(start(), 50))
        writes = run(start(split=1), 50)
        assert healthy.startswith(b"".join(writes))
        assert not any(w.startswith(b"\xaa\x55") for w in writes[1:])

    def test_coalesce(self) -> None:
        writes = run(start(coalesce=4), 8)
        assert [len(w) for w in writes] == [124, 124]

    def test_ack_in_stream(self) -> None:
        writes = run(start(ack_in_stream_every=2), 4)
        assert [b"ACK+" in w for w in writes] == [False, True, False, True]

    def test_corrupt(self) -> None:
        writes = run(start(corrupt_every=3), 6)
        good = [sum(w[6:30]) & 0xFF == w[30] for w in writes]
        assert good == [True, True, False, True, True, False]

    def test_skip(self) -> None:
        numbers = [int.from_bytes(w[4:6], "big") for w in run(start(skip_every=2), 6)]
        assert numbers == [0, 2, 4]

    def test_header_in_data(self) -> None:
        frame = run(start(header_in_data=1), 1)[0]
        assert frame.count(b"\xaa\x55") == 7
        assert frame.find(b"\xaa\x55\x00\x1b", 1) == 18
        assert struct.unpack_from("<3f", frame, 6) == pytest.approx(WRENCH[:3], rel=0.01)

    def test_stale_stream(self) -> None:
        session = SriSession(SriCore(lambda time_s: WRENCH))
        session._core.faults.inject("stale_stream")
        session.connected(0.0)
        assert session.due_s is not None

    def test_no_smpf(self) -> None:
        session = SriSession(SriCore(lambda time_s: WRENCH))
        session._core.faults.inject("no_smpf")
        assert session.receive(b"AT+SMPF=300\r\n", 0.0) == b"ACK+SMPF=$ERROR\r\n"
        assert session.receive(b"AT+SMPR=300\r\n", 0.0) == b"ACK+SMPR=300$OK\r\n"

    def test_silent_still_answers(self) -> None:
        session = start(silent=1)
        assert run(session, 5) == []
        assert session.receive(b"AT+SMPF=?\r\n", 1.0) == b"ACK+SMPF=100$OK\r\n"

    def test_half_open_answers_nothing(self) -> None:
        session = start()
        session._core.faults.inject("half_open")
        assert run(session, 5) == []
        assert session.receive(b"AT+SMPF=?\r\n", 1.0) == b""

    def test_frozen(self) -> None:
        core = SriCore(lambda time_s: (time_s, 0.0, 0.0, 0.0, 0.0, 0.0))
        session = SriSession(core)
        session.receive(b"AT+SMPF=100\r\nAT+GSD\r\n", 0.0)
        first = run(session, 1)[0]
        core.faults.inject("frozen")
        later = run(session, 3)[2]
        assert later[6:30] == first[6:30]
        assert later[4:6] != first[4:6]

    def test_saturated(self) -> None:
        frame = run(start(saturated=1), 1)[0]
        assert min(struct.unpack_from("<3f", frame, 6)) > 7000.0

    def test_values_that_jump(self) -> None:
        forces = [struct.unpack_from("<f", frame, 6)[0] for frame in run(start(jump_every=3), 6)]
        assert [force > 1000.0 for force in forces] == [False, False, True] * 2

    def test_nan(self) -> None:
        assert run(start(nan=1), 1)[0][6:30] == b"\xff" * 24

    def test_late(self) -> None:
        session = start(late_s=0.1)
        assert session.due_s == pytest.approx(0.11)
        assert session.emit(0.109) == []

    def test_unknown_name(self) -> None:
        with pytest.raises(ValueError, match="no such fault"):
            SriBox(lambda time_s: WRENCH).faults.inject("gremlin")

    def test_clear(self) -> None:
        session = start(silent=1, coalesce=3)
        session._core.faults.clear()
        assert [len(w) for w in run(session, 2)] == [31, 31]
