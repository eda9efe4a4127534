"""SJL/1 codec of the driver: golden records of docs/protocols/sjl-1.md section 8, and noise."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun import protocol
from drivers.robot.siasun.codec import decoder
from drivers.robot.siasun.codec.records import (
    Aborted,
    Ack,
    Done,
    Duplicate,
    Hello,
    Record,
    Rejected,
    Status,
    StopDone,
    StreamFigures,
    StreamOption,
    Tick,
)

POSE = (1900.0, -0.125, 927.0, 90.0, 0.0, 180.0)
SIX = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
GOLDEN_FROM_ROBOT: dict[bytes, Record] = {
    b"HELLO,SJL,1,CMD,SR500A,1.0,EUL=ZYX,UNIT=MMDEG,STEPMAX=0.5000,DEADMAN=300*49": Hello(
        "1", "CMD", "SR500A", "1.0", "ZYX", "MMDEG", 0.5, 300
    ),
    b"ACK,1*2C": Ack(1),
    b"DONE,1,1900.0000,-0.1250,927.0000,90.0000,0.0000,180.0000*22": Done(1, POSE),
    b"STAT,17,340,REM,0,1,0,0,0,100,1900.0000,-0.1250,927.0000,90.0000,0.0000,180.0000,"
    b"0.00000,-45.00000,90.00000,0.00000,45.00000,0.00000*80": Status(
        17, 340, "REM", False, True, False, False, 0, 100, POSE, (0.0, -45.0, 90.0, 0.0, 45.0, 0.0)
    ),
    b"STOPD,1,1900.0000,-0.1250,926.5000,90.0000,0.0000,180.0000*8A": StopDone(
        1, (1900.0, -0.125, 926.5, 90.0, 0.0, 180.0)
    ),
}


OFFER = StreamOption(8, StreamFigures(0.1, 0.05, 30.0, 5.0, 200))
GOLDEN_FROM_ROBOT |= {
    b"HELLO,SJL,1,CMD,SR500A,1.1,EUL=ZYX,UNIT=MMDEG,STEPMAX=0.5000,DEADMAN=300,"
    b"STREAM=8/0.1000/0.0500/30.0000/5.0000/200*EA": Hello(
        "1", "CMD", "SR500A", "1.1", "ZYX", "MMDEG", 0.5, 300, OFFER
    ),
    b"TICK,3,1024,2,0,1,1900.0000,-0.1250,926.9500,90.0000,0.0000,180.0000*40": Tick(
        3, 1024, 2, 0, 1, (1900.0, -0.125, 926.95, 90.0, 0.0, 180.0)
    ),
}


def with_sum(body: bytes) -> bytes:
    return body + b"*%02X" % (sum(body) % 256)


@pytest.mark.parametrize("line", GOLDEN_FROM_ROBOT)
def test_golden_records_from_the_robot(line: bytes) -> None:
    assert decoder.decode(line) == GOLDEN_FROM_ROBOT[line]
    assert decoder.decode(line + b"\r") == GOLDEN_FROM_ROBOT[line]


def test_golden_records_to_the_robot() -> None:
    assert protocol.accept_hello(4711) == b"OK,HELLO,1,4711*90\n"
    assert protocol.beat(4711, 9) == b"BEAT,4711,9*7A\n"
    assert protocol.abort(4711, 1) == b"ABORT,4711,1*CE\n"
    assert protocol.move_linear(4711, 1, POSE, 50.0, 200.0) == (
        b"MOVL,4711,1,1900.0000,-0.1250,927.0000,90.0000,0.0000,180.0000,50.0000,200.0000*5E\n"
    )


def test_golden_records_of_a_stream_to_the_robot() -> None:
    figures = StreamFigures(0.05, 0.02, 10.0, 2.0, 100)
    assert protocol.begin_stream(4711, 2, figures) == (
        b"STREAM,4711,2,0.0500,0.0200,10.0000,2.0000,100*42\n"
    )
    assert protocol.set_point(4711, 4, (1900.0, -0.125, 926.9, 90.0, 0.0, 180.0)) == (
        b"SET,4711,4,1900.0000,-0.1250,926.9000,90.0000,0.0000,180.0000*EC\n"
    )
    assert protocol.finish_stream(4711, 2) == b"FINISH,4711,2*18\n"


HELLO = b"HELLO,SJL,1,CMD,SR500A,1.0,EUL=ZYX,UNIT=MMDEG,STEPMAX=0.5000,DEADMAN=300"


def test_options_of_the_hello() -> None:
    known = b",STREAM=8/0.1000/0.0500/30.0000/5.0000/200"
    for options, offered in ((b"", None), (b",COLOUR=RED", None), (b",COLOUR=RED" + known, OFFER)):
        hello = decoder.decode(with_sum(HELLO + options))
        assert isinstance(hello, Hello)
        assert hello.stream == offered


@pytest.mark.parametrize(
    "option",
    [b"STREAM=", b"STREAM=8", b"STREAM=8/0.1/0.0500/30.0000/5.0000/200",
     b"STREAM=0/0.1000/0.0500/30.0000/5.0000/200", b"STREAM=8/0.1000/0.0500/30.0000/5.0000",
     b"STREAM=8/0.1000/0.0500/30.0000/5.0000/200,STREAM=8/0.1000/0.0500/30.0000/5.0000/200"],
)  # fmt: skip
def test_bad_options(option: bytes) -> None:
    with pytest.raises(ProtocolViolation):
        decoder.decode(with_sum(HELLO + b"," + option))


def test_other_records_to_the_robot() -> None:
    assert (
        protocol.step(1, 2, POSE, 0.5)
        == with_sum(b"STEP,1,2,1900.0000,-0.1250,927.0000,90.0000,0.0000,180.0000,0.5000") + b"\n"
    )
    assert (
        protocol.move_joint(1, 2, (0.0, -1e-9, 90.0, 0.0, -45.0, 5.0), 25)
        == with_sum(b"MOVJ,1,2,0.00000,0.00000,90.00000,0.00000,-45.00000,5.00000,25") + b"\n"
    )
    assert protocol.rearm(9, 3) == with_sum(b"REARM,9,3") + b"\n"
    assert protocol.refuse_hello("NAME") == with_sum(b"NO,HELLO,NAME") + b"\n"


@pytest.mark.parametrize(
    ("body", "record"),
    [
        (b"REJ,3,LIMIT", Rejected(3, "LIMIT")),
        (
            b"ABRT,3,STOP,1900.0000,-0.1250,927.0000,90.0000,0.0000,180.0000",
            Aborted(3, "STOP", POSE),
        ),
        (b"DUP,3", Duplicate(3)),
        (b"HELLO,SJL,9,whatever", Hello("9")),
    ],
)
def test_other_records_from_the_robot(body: bytes, record: Record) -> None:
    assert decoder.decode(with_sum(body)) == record


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"ACK,1",
        b"ACK,1*2D",
        b"ACK,1*2c",
        with_sum(b"NACK,1"),
        with_sum(b"ACK"),
        with_sum(b"ACK,1,2"),
        with_sum(b"ACK,-1"),
        with_sum(b"ACK,1.0"),
        with_sum("ACK,\u0661".encode()),
        with_sum(b"DONE,1,1900.0,-0.1250,927.0000,90.0000,0.0000,180.0000"),
        with_sum(b"DONE,1,1.9e3,-0.1250,927.0000,90.0000,0.0000,180.0000"),
        with_sum(b"DONE,1,+1900.0000,-0.1250,927.0000,90.0000,0.0000,180.0000"),
        with_sum(b"DONE,1,nan,-0.1250,927.0000,90.0000,0.0000,180.0000"),
        with_sum(b"HELLO,SJL"),
        with_sum(b"HELLO,SJL,1,CMD,SR500A,1.0,UNIT=MMDEG,EUL=ZYX,STEPMAX=0.5000,DEADMAN=300"),
        with_sum(b"REJ,1,limit"),
    ],
)
def test_invalid_lines(line: bytes) -> None:
    with pytest.raises(ProtocolViolation):
        decoder.decode(line)


def test_a_changed_digit_never_passes() -> None:
    good = b"STOPD,1,1900.0000,-0.1250,926.5000,90.0000,0.0000,180.0000*8A"
    for at in range(len(good) - 3):
        for byte in b"0123456789":
            if good[at] != byte:
                with pytest.raises(ProtocolViolation):
                    decoder.decode(good[:at] + bytes([byte]) + good[at + 1 :])


def drain(reader: decoder.RecordReader) -> list[Record | None]:
    """All records that wait; None stands for each violation."""
    found: list[Record | None] = []
    while True:
        try:
            record = reader.next()
        except ProtocolViolation:
            found.append(None)
        else:
            if record is None:
                return found
            found.append(record)


@given(st.lists(st.integers(1, 60), max_size=20))
def test_cuts_do_not_matter(cuts: list[int]) -> None:
    stream = b"".join(line + b"\n" for line in GOLDEN_FROM_ROBOT)
    reader, found, start = decoder.RecordReader(), [], 0
    for cut in [*cuts, len(stream)]:
        reader.feed(stream[start : start + cut])
        found += drain(reader)
        start += cut
    assert found == list(GOLDEN_FROM_ROBOT.values())


@given(st.lists(st.binary(max_size=400), max_size=5))
def test_noise_costs_no_following_record(chunks: list[bytes]) -> None:
    reader = decoder.RecordReader()
    for chunk in chunks:
        reader.feed(chunk)
        drain(reader)
    reader.feed(b"\n")
    drain(reader)
    reader.feed(b"ACK,1*2C\n")
    assert drain(reader) == [Ack(1)]


@given(st.text("ACKDONEHLSTP,.*=-0123456789", max_size=120))
def test_plausible_text_raises_only_protocol_violations(text: str) -> None:
    try:
        decoder.decode(with_sum(text.encode()))
    except ProtocolViolation:
        return


def test_longest_record() -> None:
    reader = decoder.RecordReader()
    reader.feed(b"x" * 254 + b"\n" + b"x" * 255 + b"\n" + b"x" * 1000)
    assert drain(reader) == [None, None, None]
    reader.feed(b"yyy\nACK,1*2C\n")
    assert drain(reader) == [Ack(1)]
