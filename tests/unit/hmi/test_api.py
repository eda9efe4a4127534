"""The HTTP API of a real process, asked as a browser, a program or a stranger asks."""

import socket
import time
from io import BytesIO
from pathlib import Path
from typing import cast
from urllib.parse import urlsplit

import pytest
from mcap.reader import make_reader
from pydantic import BaseModel

from cellctl.api.local_socket.messages import Answer, Failed, PlainCommand, Refused, StartCommand
from cellctl.errors.local import StopNotDelivered
from cellctl.packml.reject import RejectCode
from tests.unit.hmi.conftest import TOKEN
from tests.unit.hmi.http_client import Client, Reply
from tests.unit.hmi.scripted_daemon import PaperDaemon, snapshot

RESET = {"request": "reset"}


def problem(reply: Reply, status: int, kind: str) -> None:
    assert (reply.status, reply.headers["content-type"]) == (status, "application/problem+json")
    assert reply.json["type"] == f"urn:cellctl:{kind}"
    assert reply.json["status"] == status
    assert reply.json["title"]
    assert reply.json["instance"].startswith("/api/v1/")


def test_what_the_daemon_pushes_is_what_the_api_shows(page: Client, paper: PaperDaemon) -> None:
    shown = page.get("status").json
    assert {**shown, "mono_s": 0} == {**snapshot(), "mono_s": 0}
    paper.snapshot = snapshot(state="EXECUTE")
    end_s = time.monotonic() + 2
    while page.get("status").json["state"] != "EXECUTE":
        assert time.monotonic() < end_s
    assert page.get("permitted").json["start"]["code"] == RejectCode.ROLE_MISSING
    page.sign_in("boris")
    assert page.get("permitted").json == snapshot()["permitted"]
    assert page.get("description").json["recipes"] == paper.description["recipes"]
    assert page.get("health").json["daemon_linked"] is True
    assert page.get("curve").json["points"][-1][1] == [1.5]


def test_a_daemon_that_says_nothing_is_no_status(page: Client, paper: PaperDaemon) -> None:
    paper.silent = True
    page.until_status(503)
    problem(page.get("status"), 503, "daemon-away")
    paper.silent = False
    page.until_live()


def test_a_command_goes_to_the_daemon_with_person_role_panel_and_reason(
    page: Client, paper: PaperDaemon
) -> None:
    anna = {"person": "anna", "role": "operate", "panel": "panel-1", "idle": False}
    for told in (page.sign_in("anna").json, page.get("session").json):
        commands = told.pop("commands")
        assert told == anna
        assert (commands["reset"]["code"], commands["mode"]["needs"]) == (0, "maintain")
    start = {"request": "start", "serial": "SAT-9", "recipe": "1"}
    reply = page.command(start)
    assert (reply.status, reply.json["state"]) == (202, "EXECUTE")
    asked = paper.asked[0]
    assert asked.command == StartCommand(serial="SAT-9", recipe="1")
    by = asked.on_behalf
    assert (by.person, by.role, by.panel) == ("anna", "operate", "panel-1")
    assert (by.reason, by.decision, by.key) == ("a test", 7, "test-key-1")


@pytest.mark.parametrize(
    ("code", "status"),
    [
        (RejectCode.ROLE_MISSING, 403),
        (RejectCode.NOT_AT_A_PANEL, 403),
        (RejectCode.SUPERSEDED, 412),
        (RejectCode.COMMAND_NOT_ALLOWED, 409),
    ],
)
def test_a_refusal_is_a_problem_with_its_code(
    page: Client, paper: PaperDaemon, code: RejectCode, status: int
) -> None:
    page.sign_in("anna")
    paper.answer = Refused(code=code, text=code.text, state="IDLE")
    reply = page.command(RESET)
    problem(reply, status, "refused")
    assert (reply.json["reject_code"], reply.json["detail"]) == (code, code.text)


def test_a_fault_of_the_daemon_keeps_its_number(page: Client, paper: PaperDaemon) -> None:
    paper.answer = Failed(number=717, text="F717 not accepted")
    reply = page.command({"request": "abort"})
    problem(reply, 502, "fault-717")


class _OfAnotherVersion(BaseModel):
    kind: str = "perhaps"


def test_without_an_answer_nobody_knows(page: Client, paper: PaperDaemon, tmp_path: Path) -> None:
    paper.answer = cast(Answer, _OfAnotherVersion())
    reply = page.command({"request": "abort"})
    problem(reply, 504, "unknown")
    assert len(paper.asked) == 1
    (tmp_path / "s").unlink()
    away = page.command({"request": "abort"})
    problem(away, 503, "daemon-away")
    assert away.json["fault"] == StopNotDelivered.number


def test_somebody_who_has_not_signed_in_may_abort_at_a_panel(
    page: Client, paper: PaperDaemon
) -> None:
    assert page.command({"request": "abort"}).status == 202
    by = paper.asked[0].on_behalf
    assert (by.person, by.role, by.panel) == ("nobody", "view", "panel-1")


def test_a_page_elsewhere_is_no_panel_and_shows_nothing_to_strangers(
    page: Client, paper: PaperDaemon
) -> None:
    page.always = {"X-Forwarded-For": "192.0.2.7", "Host": "cell.example"}
    problem(page.get("status"), 401, "sign-in")
    page.always |= {"Origin": "https://cell.example"}
    assert page.sign_in("anna").json["panel"] == ""
    assert page.get("status").status == 200
    page.command({"request": "stop"})
    assert paper.asked[0].on_behalf.panel == ""


def test_a_proxy_that_names_no_client_makes_no_panel(page: Client) -> None:
    page.always = {"Host": "cell.example"}
    problem(page.get("status"), 401, "sign-in")


def test_a_program_has_a_token_that_expires(page: Client, paper: PaperDaemon) -> None:
    bearer = f"Bearer {TOKEN}line"
    assert page.command(RESET, Authorization=bearer, Origin="").status == 202
    by = paper.asked[0].on_behalf
    assert (by.person, by.panel) == ("line", ""), "a program sees no cell, wherever it runs"
    for wrong in (f"Bearer {TOKEN}old", "Bearer nothing"):
        refused = page.get("status", Authorization=wrong)
        problem(refused, 401, "token")
        assert refused.headers["www-authenticate"] == "Bearer"


@pytest.mark.parametrize(
    ("headers", "status", "kind"),
    [
        ({"Origin": "http://evil.example"}, 403, "origin"),
        ({"Origin": "", "Sec_Fetch_Site": "same-site"}, 403, "origin"),
        ({"Origin": ""}, 403, "origin"),
        ({"Content_Type": "text/plain"}, 415, "media-type"),
        ({"Host": "evil.example"}, 421, "host"),
        ({"Content_Length": "999999"}, 413, "body"),
    ],
)
def test_another_page_cannot_make_the_browser_command_the_cell(
    page: Client, paper: PaperDaemon, headers: dict[str, str], status: int, kind: str
) -> None:
    page.sign_in("anna")
    problem(page.command(RESET, 7, **headers), status, kind)
    assert paper.asked == []


def test_signing_in(page: Client) -> None:
    problem(page.sign_in("anna", "wrong!"), 401, "sign-in")
    problem(page.sign_in("nobody"), 401, "sign-in")
    first = page.sign_in("anna")
    for word in ("__Host-", "HttpOnly", "Secure", "SameSite=strict"):
        assert word in first.headers["set-cookie"]
    page.request("DELETE", "/api/v1/session", {})
    assert page.get("session").json["person"] == "", "the cookie is worth nothing any more"
    for _ in range(2):
        page.sign_in("anna", "wrong!")
    late = page.sign_in("anna")
    problem(late, 429, "sign-ins")
    assert int(late.headers["retry-after"]) > 0


def test_twenty_commands_a_minute_and_any_number_of_stops(page: Client, paper: PaperDaemon) -> None:
    page.sign_in("anna")
    for _ in range(20):
        assert page.command(RESET).status == 202
    problem(page.command(RESET), 429, "commands")
    for name in ("stop", "abort"):
        assert page.command({"request": name}).status == 202
    assert isinstance(paper.asked[-1].command, PlainCommand)


@pytest.mark.parametrize(
    "body",
    [
        {"command": {"request": "dance"}},
        {"command": {"request": "reset", "more": 1}},
        {"command": {"request": "start", "serial": 5}},
        {"decision": 3},
        [],
    ],
)
def test_what_is_no_command_is_named(page: Client, paper: PaperDaemon, body: object) -> None:
    reply = page.request("POST", "/api/v1/commands", body, Idempotency_Key="test-key-x")
    problem(reply, 422, "invalid")
    assert reply.json["errors"]
    problem(page.command(RESET, Idempotency_Key=""), 422, "invalid")
    assert paper.asked == []


def test_runs_are_found_by_serial_result_and_calibration(page: Client) -> None:
    assert [run["number"] for run in page.get("runs").json["runs"]] == [2, 1]
    for query, numbers in {
        "serial=SAT": [2, 1],
        "serial=SAT-1": [1],
        "result=aborted": [2],
        "calibration=id-SAT-1": [1],
        "before=2": [1],
        "limit=1": [2],
        "recipe=a%20part&operator=": [2, 1],
        "fault=304": [],
        "since=2000-01-01T00:00:00Z": [2, 1],
        "until=2000-01-01T00:00:00%2B08:00": [],
    }.items():
        found = [run["number"] for run in page.get(f"runs?{query}").json["runs"]]
        assert found == numbers, query
    for wrong in ("limit=0", "since=2026-11-24T12:00:00", "fault=x", "order=1", f"before={10**20}"):
        problem(page.get(f"runs?{wrong}"), 422, "invalid")
    listed = {run["number"]: run for run in page.get("runs").json["runs"]}
    assert [listed[number]["part_verdict"] for number in (1, 2)] == ["good", "aborted"]
    run = page.get("runs/1").json
    assert (run["head"]["serial"], run["part_verdict"], run["sealed"]) == ("SAT-1", "good", True)
    assert run["phases"][0]["label"] == "measure"
    for unknown in (99, 10**20):
        problem(page.get(f"runs/{unknown}"), 404, "fault-804")


def test_files_of_a_run_cannot_become_a_page_of_ours(page: Client, tmp_path: Path) -> None:
    picture = page.get("runs/1/artefacts/look.png")
    assert picture.body.endswith(b"SAT-1")
    assert picture.headers["content-type"] == "image/png"
    again = page.get("runs/1/artefacts/look.png", If_None_Match=picture.headers["etag"])
    assert (again.status, again.body) == (304, b"")
    assert "attachment" in page.get("runs/1/artefacts/page.html").headers["content-disposition"]
    problem(page.get("runs/1/artefacts/none.png"), 404, "file-unknown")
    for file in (tmp_path / "store" / "files").rglob("*"):
        if file.is_file() and file.read_bytes().endswith(b"SAT-1"):
            file.write_bytes(b"changed")
    assert page.get("runs/1/artefacts/look.png").status == 410


def test_the_report_of_a_run_is_a_file_to_keep(page: Client) -> None:
    report = page.get("runs/1/report")
    assert (report.status, report.headers["content-type"]) == (200, "text/html; charset=utf-8")
    assert "attachment" in report.headers["content-disposition"]
    assert b"SAT-1" in report.body
    problem(page.get("runs/99/report"), 404, "fault-804")


@pytest.mark.figures  # made by a program, as is the archive
def test_the_recording_of_a_run_is_a_file_for_viewers(page: Client) -> None:
    recording = page.get("runs/1/recording?images=none")
    assert recording.status == 200
    assert 'filename="run-1.mcap"' in recording.headers["content-disposition"]
    assert recording.headers["content-length"] == str(len(recording.body))
    summary = make_reader(BytesIO(recording.body)).get_summary()
    assert summary is not None
    assert "/steps" in {channel.topic for channel in summary.channels.values()}
    problem(page.get("runs/99/recording"), 404, "fault-804")
    problem(page.get("runs/1/recording?images=big"), 422, "invalid")


def test_the_audit_log_is_for_those_who_maintain(page: Client) -> None:
    page.sign_in("anna")
    problem(page.get("audit"), 403, "role")
    page.sign_in("boris")
    entries = page.get("audit").json["entries"]
    assert [entry["detail"] for entry in entries if entry["action"] == "reset"] == [
        {"reason": "shift begins"}
    ]


def test_faults_and_version(page: Client) -> None:
    assert page.get("faults/712").json["number"] == 712
    problem(page.get("faults/1"), 404, "fault-unknown")
    assert "cellctl" in page.get("version").json["version"]
    problem(page.get("nothing"), 404, "http")


def test_the_document_of_the_api_loads_nothing_from_elsewhere(page: Client) -> None:
    document = page.get("openapi.json").json
    assert document["openapi"].startswith("3.1")
    assert "/api/v1/commands" in document["paths"]
    assert page.request("GET", "/docs").status == 404


def test_the_page_is_small_and_may_load_only_from_here(page: Client) -> None:
    index = page.request("GET", "/")
    policy = index.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    folder = Path(__file__).parents[3] / "cellctl/hmi/page"
    sent = 0
    for path in folder.iterdir():
        if path.suffix != ".svg":
            assert b"http" not in path.read_bytes().replace(b"http://www.w3.org", b""), path
        address = f"/page/{path.name}"
        if not path.name.startswith("texts."):  # with the words of faults besides
            assert page.request("GET", address).body == path.read_bytes()
        sent += len(page.request("GET", address, Accept_Encoding="gzip").body)
    assert sent < 100_000


def stream(page: Client, cookie: str = "") -> socket.socket:
    address = urlsplit(page.url)
    assert address.port is not None
    connection = socket.create_connection(("127.0.0.1", address.port), timeout=10)
    lines = [f"GET /api/v1/events HTTP/1.1\r\nHost: {address.netloc}\r\n"]
    if cookie:
        lines.append(f"Cookie: {cookie}\r\n")
    connection.sendall("".join([*lines, "\r\n"]).encode())
    return connection


def test_the_fifth_page_is_told_why(page: Client) -> None:
    streams = [stream(page) for _ in range(4)]
    for one in streams:
        assert b"200 OK" in one.recv(100)
    fifth = stream(page)
    assert b"429" in fifth.recv(100)
    fifth.close()
    streams.pop().close()
    end_s = time.monotonic() + 5
    while page.get("health").json["pages_open"] > 3:
        assert time.monotonic() < end_s, "a page that has gone is not counted any more"
        time.sleep(0.1)
    for one in streams:
        one.close()


def test_events_come_as_the_daemon_sent_them_and_slow_readers_delay_nobody(
    page: Client, paper: PaperDaemon
) -> None:
    # Large snapshots fill the buffers of the readers that do not read within the test.
    paper.snapshot = snapshot(links={f"device {i}": "x" * 200 for i in range(60)})
    slow = [stream(page) for _ in range(3)]
    quick = stream(page)
    received = b""
    end_s = time.monotonic() + 2.5
    while time.monotonic() < end_s:
        received += quick.recv(65536)
    assert received.count(b"event: snapshot\n") > 15
    assert b"event: description\n" in received
    assert page.get("status").status == 200
    for one in (*slow, quick):
        one.close()
