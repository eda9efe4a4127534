"""Requests and answers byte by byte; the frames are worked out from the specification."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.api.modbus.pdu import Responder
from cellctl.api.modbus.register_blocks import RegisterFile

PLC = "192.0.2.10"


class Line:
    def __init__(self) -> None:
        self.commits = 0
        self.beats: list[int] = []
        self.registers = RegisterFile(on_commit=self._commit, on_heartbeat=self._beat)
        self.registers.publish(tuple(range(125)))
        self._responder = Responder(self.registers, ("V", "Prod", "1.2"))

    def _commit(self, _client: str) -> None:
        self.commits += 1

    def _beat(self, _client: str, value: int) -> None:
        self.beats.append(value)

    def ask(self, request: str) -> str:
        return self._responder.answer(bytes.fromhex(request), PLC).hex(" ")


@pytest.fixture
def line() -> Line:
    return Line()


def test_fc4_reads_the_whole_block(line: Line) -> None:
    answer = bytes.fromhex(line.ask("04 0000 007D"))
    assert answer[:2] == b"\x04\xfa"
    assert answer[2:6] == b"\x00\x00\x00\x01"
    assert len(answer) == 2 + 250


def test_fc16_writes_the_block_and_commits_once(line: Line) -> None:
    block = "0001 0002 0000 0000 0000 0000" + "4142" * 12 + "0000" * 8 + "0000 0007"
    assert line.ask("10 0000 001C 38" + block) == "10 00 00 00 1c"
    assert line.commits == 1
    assert line.registers.holding[6] == 0x4142
    assert line.registers.holding[27] == 7
    assert line.ask("03 001B 0001") == "03 02 00 07"


def test_fc6_and_fc22_and_fc23(line: Line) -> None:
    assert line.ask("06 0028 0005") == "06 00 28 00 05"
    assert line.beats == [5]
    line.ask("06 0003 0012")
    assert line.ask("16 0003 00F2 0025") == "16 00 03 00 f2 00 25"
    assert line.registers.holding[3] == 0x17  # the specification's own example
    assert line.ask("17 0028 0001 0028 0001 02 0009") == "17 02 00 09"
    assert line.beats == [5, 9]


@pytest.mark.parametrize(
    ("request_", "answer"),
    [
        ("03 0000 0000", "83 03"),
        ("03 0000 007E", "83 03"),
        ("03 0000", "83 03"),
        ("03 0000 0001 00", "83 03"),
        ("04 0001 007D", "84 02"),
        ("04 FFFF 0001", "84 02"),
        ("03 0029 0001", "83 02"),
        ("03 0000 002A", "83 02"),
        ("06 0006 4142", "86 02"),
        ("06 0064 0000", "86 02"),
        ("10 0006 0002 04 4142 4344", "90 02"),
        ("10 0000 0007 0E" + "0000" * 7, "90 02"),
        ("10 0000 0002 02 0000 0000", "90 03"),
        ("10 0000 0002 04 0000", "90 03"),
        ("10 0000 0000 00", "90 03"),
        ("16 001C 0000 0000", "96 02"),
        ("17 0000 0001 001C 0001 02 0000", "97 02"),
        ("17 0029 0001 0000 0001 02 0005", "97 02"),
        ("17 0000 0000 0000 0001 02 0000", "97 03"),
        ("01 0000 0001", "81 01"),
        ("05 0000 FF00", "85 01"),
        ("08 0000 1234", "88 01"),
        ("0B", "8b 01"),
        ("11", "91 01"),
        ("14 00", "94 01"),
        ("41", "c1 01"),
        ("2B 0D 01 00", "ab 01"),
        ("2B 0E 05 00", "ab 03"),
        ("2B 0E 04 09", "ab 02"),
    ],
)
def test_bad_requests_get_their_exception(line: Line, request_: str, answer: str) -> None:
    before = line.registers.holding
    assert line.ask(request_) == answer
    assert line.registers.holding == before
    assert line.commits == 0


def test_identification(line: Line) -> None:
    assert bytes.fromhex(line.ask("2B 0E 01 00")) == (
        b"\x2b\x0e\x01\x81\x00\x00\x03\x00\x01V\x01\x04Prod\x02\x031.2"
    )
    assert bytes.fromhex(line.ask("2B 0E 04 01")) == b"\x2b\x0e\x04\x81\x00\x00\x01\x01\x04Prod"


@given(st.binary(min_size=1, max_size=253))
def test_any_request_gets_one_answer_of_its_function(pdu: bytes) -> None:
    registers = RegisterFile(
        on_commit=lambda _client: None, on_heartbeat=lambda _client, _value: None
    )
    before = registers.holding
    answer = Responder(registers, ("V", "P", "1")).answer(pdu, PLC)
    assert answer[0] in (pdu[0], pdu[0] | 0x80)
    assert len(answer) <= 253
    if answer[0] != pdu[0]:
        assert registers.holding == before
