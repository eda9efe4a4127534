"""Alarms by occurrence: found, told with their remedy, and kept when they were acknowledged."""

import pytest

from cellctl.errors.force import ForceLimitExceeded
from cellctl.hmi.problems import MEDIA_TYPE
from cellctl.translations import fault_words
from tests.unit.hmi.in_process import Api


@pytest.mark.parametrize(
    ("query", "found"),
    [
        ("", [3, 2, 1]),
        ("active=true", [3, 2]),
        ("active=false", [1]),
        ("number=207", [3, 2]),
        ("run=2", [1]),
        ("before=3&limit=1", [2]),
        ("since=2000-01-01T00:00:00Z", [3, 2, 1]),
        ("until=2000-01-01T00:00:00%2B08:00", []),
    ],
)
async def test_alarms_are_found_by_what_is_known_of_them(
    api: Api, query: str, found: list[int]
) -> None:
    reply = (await api.get(f"alarms?{query}")).json
    assert [one["id"] for one in reply["alarms"]] == found
    assert reply["last_hour"] == 3, "whatever is asked for"


@pytest.mark.parametrize("query", ["limit=0", "active=perhaps", "since=2026-01-01", "order=1"])
async def test_what_is_no_question_is_named(api: Api, query: str) -> None:
    reply = await api.get(f"alarms?{query}")
    assert (reply.status, reply.headers["content-type"]) == (422, MEDIA_TYPE)
    assert reply.json["errors"]


async def test_an_acknowledged_alarm_says_by_whom_and_what_to_do(api: Api) -> None:
    told = (await api.get("alarms/1")).json
    assert (told["number"], told["run"], told["active"]) == (512, 2, False)
    assert told["acknowledged_by"] == "page:anna@panel-1"
    assert told["acknowledged"] >= told["time"]
    assert told["reaction"] == "abort"
    assert told["remedy"] == ForceLimitExceeded.remedy
    chinese = await api.get("alarms/1", Accept_Language="zh-CN")
    assert chinese.headers["content-language"] == "zh"
    assert chinese.json["remedy"] == fault_words(ForceLimitExceeded, "zh").remedy
    assert "-50.8 N" in chinese.json["text"], "facts stay as the cell said them"


async def test_an_alarm_of_a_process_that_is_gone_is_told_all_the_same(api: Api) -> None:
    for number in (99, 2**53 - 1):
        reply = await api.get(f"alarms/{number}")
        assert (reply.status, reply.json["type"]) == (404, "urn:cellctl:alarm-unknown")


async def test_alarms_are_read_while_the_daemon_is_away(api: Api) -> None:
    api.parts.hub.snapshot = {}
    assert (await api.get("status")).status == 503
    assert (await api.get("alarms/3")).json["active"] is True
