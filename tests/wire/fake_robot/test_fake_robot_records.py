"""SJL/1 records of the fake controller: golden records of the protocol document, section 8."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fakes.wire.sjl.records import (
    RecordError,
    decode,
    encode,
    fixed,
    integer,
    joint_fields,
    number,
    pose_fields,
)
from fakes.world.frames import from_written

DOCUMENT = Path(__file__).parents[3] / "docs" / "protocols" / "sjl-1.md"
GOLDEN = [
    line.strip()
    for line in DOCUMENT.read_text(encoding="utf-8").partition("## 8")[2].splitlines()
    if line.startswith("    ")
]


def test_document_has_golden_records() -> None:
    assert len(GOLDEN) == 14


@pytest.mark.parametrize("record", GOLDEN)
def test_golden_records_both_ways(record: str) -> None:
    fields = decode(record.encode())
    assert encode(fields) == record.encode() + b"\n"


def test_golden_pose_and_joints() -> None:
    pose = from_written([1900, -0.125, 927, 90, 0, 180])
    assert (
        ",".join(pose_fields(pose.as_matrix()))
        == "1900.0000,-0.1250,927.0000,90.0000,0.0000,180.0000"
    )
    joints = np.deg2rad([0, -45, 90, 0, 45, 0])
    assert joint_fields(joints.tolist())[1] == "-45.00000"


@pytest.mark.parametrize(
    "line",
    [
        b"ACK,1*2D",
        b"ACK,1*2c",
        b"ACK,1",
        b"",
        b"*",
        b"ACK,1*",
        b"ACK,\xc3\xbc*7B",
        b"ACK,1*2C ",
    ],
)
def test_spoiled_records_are_refused(line: bytes) -> None:
    with pytest.raises(RecordError):
        decode(line)


def test_carriage_return_is_ignored() -> None:
    assert decode(b"ACK,1*2C\r") == ["ACK", "1"]


@pytest.mark.parametrize(
    ("value", "text"),
    [(-0.00001, "0.0000"), (0.0, "0.0000"), (-0.00006, "-0.0001"), (12, "12.0000")],
)
def test_no_negative_zero(value: float, text: str) -> None:
    assert fixed(value, 4) == text


@pytest.mark.parametrize("text", ["1e3", "+1", "nan", "inf", "", "-", ".", "1.2.3", "0x1", "1 "])
def test_numbers_are_plain_fixed_point(text: str) -> None:
    with pytest.raises(RecordError):
        number(text)


@pytest.mark.parametrize("text", ["-1", "1.0", "", "²"])
def test_integers_are_plain(text: str) -> None:
    with pytest.raises(RecordError):
        integer(text)


@given(st.binary(max_size=300))
def test_any_bytes_are_a_record_or_an_error(line: bytes) -> None:
    try:
        fields = decode(line)
    except RecordError:
        return
    assert encode(fields)[:-1] == line.removesuffix(b"\r")


def test_record_longer_than_255_bytes_is_refused() -> None:
    with pytest.raises(RecordError):
        encode(["X" * 252])
