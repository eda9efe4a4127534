"""Nothing but a whole, exact message is a request; everything else is F713."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cellctl.api.local_socket.messages import (
    AcknowledgeCommand,
    ModeCommand,
    PlainCommand,
    ProcedureCommand,
    Refused,
    Request,
    StartCommand,
    StatusRequest,
    Taken,
    parse_answer,
    parse_request,
    to_line,
)
from cellctl.errors.local import MessageMalformed

REQUESTS: tuple[Request, ...] = (
    StatusRequest(),
    *(PlainCommand(request=n) for n in ("clear", "reset", "hold", "unhold", "stop", "abort")),
    StartCommand(serial="SAT-1", recipe="panel", order="OP-3", dry_run=True, single_step=True),
    ProcedureCommand(number=107, serial="P"),
    ModeCommand(mode="maintenance"),
    AcknowledgeCommand(number=202),
)
NAMES = [request.request for request in REQUESTS]


@pytest.mark.parametrize("request_", REQUESTS, ids=NAMES)
def test_a_request_comes_out_as_it_went_in(request_: Request) -> None:
    line = to_line(request_)
    assert line.count(b"\n") == 1
    assert parse_request(line) == request_


@pytest.mark.parametrize("answer", [Taken(state="IDLE"), Refused(code=1, text="no", state="IDLE")])
def test_an_answer_too(answer: Taken | Refused) -> None:
    assert parse_answer(to_line(answer)) == answer


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"{}",
        b"null",
        b"[]",
        b'"abort"',
        b'{"request": "abort"',
        b'{"request": "abort"} {"request": "reset"}',
        b'{"request": "ABORT"}',
        b'{"request": "complete"}',
        b'{"request": "reset", "force": true}',
        b'{"request": "start"}',
        b'{"request": "start", "serial": 7}',
        b'{"request": "start", "serial": "S", "dry_run": "yes"}',
        b'{"request": "start", "serial": "S", "dry_run": 1}',
        b'{"request": "start", "serial": "0123456789012345678901234"}',
        b'{"request": "procedure", "number": "107", "serial": "P"}',
        b'{"request": "procedure", "number": 107.5, "serial": "P"}',
        b'{"request": "procedure", "number": true, "serial": "P"}',
        b'{"request": "mode", "mode": 1}',
        b'{"request": "mode", "mode": "automatic"}',
        b'{"request": "acknowledge", "number": 0}',
        b'{"request": "acknowledge", "number": 1e400}',
        b'\xff{"request": "abort"}',
        b"[" * 4000,
    ],
)
def test_what_is_not_exact_is_refused(line: bytes) -> None:
    with pytest.raises(MessageMalformed, match="F713"):
        parse_request(line)


@settings(deadline=None)
@given(st.binary(max_size=200))
def test_no_bytes_are_taken_for_a_command(line: bytes) -> None:
    with pytest.raises(MessageMalformed):
        parse_request(line)


_PLAIN = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=30)
_VALUES = _PLAIN | st.lists(_PLAIN, max_size=2) | st.just({"request": "abort"})
_KEYS = st.sampled_from(
    ["serial", "recipe", "order", "dry_run", "single_step", "number", "mode", "request", "x"]
)


@settings(deadline=None)
@given(st.sampled_from(NAMES), st.dictionaries(_KEYS, _VALUES, max_size=5))
def test_a_document_is_a_request_of_its_name_or_none(name: str, others: dict[str, object]) -> None:
    """Whatever else stands in it, Python's JSON with its NaN and Infinity included."""
    line = json.dumps({**others, "request": name}).encode()
    try:
        request = parse_request(line)
    except MessageMalformed:
        return
    assert request.request == name
    given_values = json.loads(line)
    assert {key: getattr(request, key) for key in given_values} == given_values


@settings(deadline=None)
@given(st.sampled_from(REQUESTS), st.data())
def test_a_damaged_request_is_no_other_command(request_: Request, data: st.DataObject) -> None:
    """One byte lost or changed never turns a request into one with another name."""
    line = to_line(request_)[:-1]
    place = data.draw(st.integers(0, len(line) - 1))
    byte = data.draw(st.binary(max_size=1))
    try:
        request = parse_request(line[:place] + byte + line[place + 1 :])
    except MessageMalformed:
        return
    assert request.request == request_.request
