"""The API answers in the language that a client asks for."""

import gzip
import json

import pytest

from cellctl.api.local_socket.messages import Refused
from cellctl.fault_catalogue import known_fault
from cellctl.hmi.words.languages import preferred
from cellctl.hmi.words.page_words import page_words
from cellctl.packml.reject import RejectCode
from cellctl.translations import fault_words, label
from tests.unit.hmi.http_client import Client
from tests.unit.hmi.scripted_daemon import NAMES, PaperDaemon, alarm, snapshot


@pytest.mark.parametrize(
    ("accepted", "language"),
    [
        ("", "en"),
        ("*", "en"),
        ("de, fr;q=0.5", "en"),
        ("zh-CN,zh;q=0.9,en;q=0.8", "zh"),
        ("ZH-Hans", "zh"),
        ("en-GB, zh;q=0.9", "en"),
        ("en;q=0.5, zh;q=0.7", "zh"),
        ("zh;q=0", "en"),
        ("zh;q=much", "en"),
    ],
)
def test_the_language_that_is_liked_best(accepted: str, language: str) -> None:
    assert preferred(accepted) == language


def test_a_fault_is_told_in_chinese(page: Client) -> None:
    fault = known_fault(207)
    assert fault is not None
    chinese = fault_words(fault, "zh")
    reply = page.get("faults/207", Accept_Language="zh-CN")
    assert (reply.json["text"], reply.json["cause"]) == (chinese.text, chinese.cause)
    assert reply.headers["content-language"] == "zh"
    assert "Accept-Language" in reply.headers["vary"]
    english = page.get("faults/207")
    assert (english.json["text"], english.headers["content-language"]) == (fault.text, "en")


def test_what_the_cell_says_is_told_in_chinese(page: Client, paper: PaperDaemon) -> None:
    old, code = known_fault(207), RejectCode.LINE_IN_CONTROL
    assert old is not None
    told = alarm(207, f"{old.text}: 0.31 s") | {"cause": old.cause, "remedy": old.remedy}
    paper.snapshot = snapshot(
        alarms=[told, alarm(1999, "of a plug-in")],
        step={"number": 50, "label": "mate", "text": "axis A1: stop 2 of 3"},
        permitted={name: {"code": int(code), "reason": code.text} for name in NAMES},
        links={"robots.main": str(old("main"))},
    )
    paper.description["procedures"] = [{"number": 106, "name": "identify payload"}]
    page.until(lambda: page.get("status").json["alarms"] != [])
    chinese = fault_words(old, "zh")
    shown = page.get("status", Accept_Language="zh").json
    assert [one["text"] for one in shown["alarms"]] == [
        f"F207 {chinese.text}：0.31 s",
        "F1999 of a plug-in",
    ]
    assert shown["alarms"][0]["remedy"] == chinese.remedy
    assert shown["alarms"][1]["remedy"] == "a remedy"
    assert shown["links"] == {"robots.main": f"F207 {chinese.text}：main"}
    assert shown["step"]["label"] == label("mate", "zh")
    refusal = page_words("zh")[f"reject_{int(code)}"]
    assert shown["permitted"]["start"]["reason"] == refusal
    page.sign_in("boris")
    assert page.get("permitted", Accept_Language="zh").json == shown["permitted"]
    page.until(lambda: "identify" in str(page.get("description").json))
    described = page.get("description", Accept_Language="zh").json
    assert described["procedures"][0]["name"] == label("identify payload", "zh")


def test_a_refusal_and_a_problem_are_told_in_chinese(page: Client, paper: PaperDaemon) -> None:
    page.sign_in("anna")
    code = RejectCode.COMMAND_NOT_ALLOWED
    paper.answer = Refused(code=code, text=code.text, state="IDLE")
    reply = page.command({"request": "reset"}, Accept_Language="zh")
    assert (reply.status, reply.json["reject_code"]) == (409, int(code))
    assert reply.json["detail"] == page_words("zh")[f"reject_{int(code)}"]
    unknown = known_fault(804)
    assert unknown is not None
    problem = page.get("runs/4711", Accept_Language="zh").json
    assert problem["detail"].startswith(f"F804 {fault_words(unknown, 'zh').text}")
    assert problem["remedy"] == fault_words(unknown, "zh").remedy
    assert page.get("runs/4711").json["remedy"] == unknown.remedy


def test_the_page_is_sent_packed_to_whoever_can_unpack_it(page: Client) -> None:
    plain = page.request("GET", "/page/texts.zh.json")
    packed = page.request("GET", "/page/texts.zh.json", Accept_Encoding="gzip, br")
    assert packed.headers["content-encoding"] == "gzip"
    assert gzip.decompress(packed.body) == plain.body
    assert json.loads(plain.body) == page_words("zh")
    assert len(packed.body) < len(plain.body) / 2
    tags = [reply.headers["etag"] for reply in (plain, packed)]
    assert tags[0] != tags[1]
    again = page.request(
        "GET", "/page/texts.zh.json", Accept_Encoding="gzip", If_None_Match=tags[1]
    )
    assert (again.status, again.body) == (304, b"")
