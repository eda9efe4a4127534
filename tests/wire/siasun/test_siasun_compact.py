"""Golden records of SJL/2 (docs/protocols/sjl-2.md, section 5) and what is no record."""

import pytest

from cellctl.errors.link import ProtocolViolation
from drivers.robot.siasun.codec.compact.decoder import decode_compact
from drivers.robot.siasun.codec.compact.words import CompactWords
from drivers.robot.siasun.codec.decoder import RecordReader
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
)
from drivers.robot.siasun.codec.words import words_of

WORDS = CompactWords(1000.0)
POSE = (1900.0, -0.125, 927.0, 90.0, 0.0, 180.0)
WRITTEN = b"19000000,-1250,9270000,900000,0,1800000"
HELLO = b"HELLO,SJL,2,CMD,SR500A,2.1,EUL=ZYX,UNIT=MMDEG,STEPMAX=0.5000,DEADMAN=300"


def test_what_the_pc_says() -> None:
    assert WORDS.accept_hello(4711) == b"OKAY100471110000002004711;"
    assert WORDS.beat(4711, 9) == b"BEAT100471110000092004720;"
    assert WORDS.abort(4711, 1) == b"ABRT100471110000012004712;"
    assert WORDS.move_linear(4711, 1, POSE, 50.0, 200.0) == (
        b"MOVL10047111000001501900.0000499999.8750500927.0000500090.0000"
        b"500000.0000500180.0000500050.0000500020.00006007878.8750;"
    )


@pytest.mark.parametrize(
    "record",
    [
        WORDS.move_linear(999_999, 999_999, (-9999.0,) * 6, 0.0001, 9999.0),
        WORDS.move_joint(1, 1, (-360.0, 360.0, -0.00001, 0.0, 179.99999, -5.5), 100),
        WORDS.step(1, 1, POSE, 250.0),
        WORDS.rearm(1, 1),
    ],
)
def test_every_command_has_the_length_that_the_job_receives(record: bytes) -> None:
    assert len(record) == 119


@pytest.mark.parametrize(
    ("body", "record"),
    [
        (b"ACK,1,1", Ack(1)),
        (b"DUP,3,3", Duplicate(3)),
        (b"REJ,2,STEP,2", Rejected(2, "STEP")),
        (b"DONE,1,%b,30968751" % WRITTEN, Done(1, POSE)),
        (b"ABRT,1,STOP,%b,30968751" % WRITTEN, Aborted(1, "STOP", POSE)),
        (b"STOPD,1,%b,30968751" % WRITTEN, StopDone(1, POSE)),
    ],
)
def test_what_the_robot_says(body: bytes, record: Record) -> None:
    assert decode_compact(body) == record


def test_a_report() -> None:
    body = b"STAT,17,340,6,0,0,0,100,%b,0,-4500000,9000000,0,4500000,0,39969213" % WRITTEN
    status = decode_compact(body)
    assert isinstance(status, Status)
    assert (status.count, status.robot_ms, status.mode) == (17, 340, "REM")
    assert (status.drives_on, status.emergency_stop, status.moving) == (True, False, False)
    assert status.flange_xyzabc == pytest.approx(POSE)
    assert status.joints_deg == pytest.approx((0.0, -45.0, 90.0, 0.0, 45.0, 0.0))


@pytest.mark.parametrize(
    "body",
    [
        b"ACK,1,2",
        b"ACK,1",
        b"ACK,+1,1",
        b"ACK,1.0,1",
        b"REJ,2,step,2",
        b"JUMP,1,1",
        b"DONE,1,%b,30968752" % WRITTEN,
        b"STAT,17,340,12,0,0,0,100,%b,0,0,0,0,0,0,30969219" % WRITTEN,
    ],
)
def test_what_is_no_record(body: bytes) -> None:
    with pytest.raises(ProtocolViolation):
        decode_compact(body)


def hello(data: bytes) -> Record | None:
    reader = RecordReader()
    reader.feed(data)
    return reader.next()


def test_the_hello_decides_the_form() -> None:
    record = hello(HELLO + b",ACC=1000.0000;")
    assert isinstance(record, Hello)
    assert (record.compact, record.acceleration_max_mm_s2) == (True, 1000.0)
    assert isinstance(words_of(record), CompactWords)
    assert hello(b"HELLO,SJL,9,whatever;") == Hello("9")


@pytest.mark.parametrize(
    "data",
    [HELLO + b";", HELLO + b",ACC=0.0000;", HELLO.replace(b"SJL,2", b"SJL,1") + b",X=1;"],
)
def test_a_hello_without_what_its_form_needs_is_refused(data: bytes) -> None:
    with pytest.raises(ProtocolViolation):
        hello(data)
