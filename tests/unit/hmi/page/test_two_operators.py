"""Two people before one cell, and one person whose page or session goes."""

import os
import re
import signal
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect

from cellctl.api.local_socket.messages import (
    Answer,
    CommandRequest,
    PageCommand,
    Refused,
    Request,
    Taken,
)
from cellctl.api.local_socket.page_desk import PageDesk
from cellctl.api.local_socket.users import Users
from cellctl.hmi.answers.permissions import session_told
from cellctl.hmi.visitors.access import Visitor
from cellctl.packml.reject import RejectCode
from tests.unit.hmi.page.screen import Screen, Tabs
from tests.unit.hmi.scripted_daemon import PaperDaemon, page_process, page_thread, serving, snapshot

STATES = {"hold": "HELD", "unhold": "EXECUTE", "stop": "STOPPED", "abort": "ABORTED"}

HELD_BACK = """() => {
    const now = window.fetch;
    const go = new Promise((done) => { window.go = done; });
    window.fetch = async (...given) => {
        if (String(given[0]).endsWith("commands")) await go;
        return now(...given);
    };
}"""
SENT = """async ([key, decision]) => {
    const headers = { "Content-Type": "application/json", "Idempotency-Key": key };
    const body = JSON.stringify({ command: { request: "hold" }, decision });
    const reply = await fetch("/api/v1/commands", { method: "POST", headers, body });
    return [reply.status, await reply.json()];
}"""


@dataclass
class JudgingDaemon(PaperDaemon):
    """Judges people by the desk of the daemon, and changes its state by what it takes."""

    obeyed: list[tuple[str, str]] = field(default_factory=list)
    turned_down: list[tuple[str, str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._desk = PageDesk("", Users(), self._decision, self._obey, self._note)

    def _decision(self) -> int:
        return int(self.snapshot["decision"])

    async def handle(self, request: Request, _uid: int) -> Answer:
        assert isinstance(request, PageCommand)
        self.asked.append(request)
        return await self._desk.handle(request, os.getuid())

    async def _obey(
        self, request: CommandRequest, who: str, _details: Mapping[str, str]
    ) -> Taken | Refused:
        self.obeyed.append((who, request.request))
        # What two people press at once may come in any order: a Stop does not end an abort.
        aborted = self.snapshot["state"] == "ABORTED" and request.request == "stop"
        state = "ABORTED" if aborted else STATES[request.request]
        last = {"who": f"page:{who}", "command": request.request, "time": "2026-01-02T10:03:04Z"}
        changes = {"state": state, "state_requested": state, "last_command": last}
        self.snapshot = self.snapshot | changes | {"decision": self._decision() + 1}
        return Taken(state=state)

    def _note(
        self, request: CommandRequest, who: str, code: RejectCode, _details: Mapping[str, str]
    ) -> None:
        self.turned_down.append((who, request.request, code.name))


@pytest.fixture
def paper() -> JudgingDaemon:
    run = {"number": 2, "serial": "SAT-2", "recipe": 1, "result": "none", "good_parts": 4}
    step = {"number": 50, "label": "mate", "text": "pass 2"}
    running = snapshot(state="EXECUTE", state_requested="EXECUTE", run=run, step=step)
    return JudgingDaemon(snapshot=running)


@pytest.fixture
def pair(tabs: Tabs, address: str) -> Iterator[tuple[Screen, Screen]]:
    with Screen(tabs, address) as anna, Screen(tabs, address) as boris:
        anna.sign_in("anna")
        boris.sign_in("boris")
        yield anna, boris


def said(screen: Screen, name: str) -> Any:
    return screen.tab.locator(f"[data-command={name}] small")


def test_both_see_the_same_and_of_two_that_press_at_once_one_is_told_who_was_quicker(
    pair: tuple[Screen, Screen], paper: JudgingDaemon
) -> None:
    for one in pair:
        expect(one.tab.locator("#now")).to_contain_text("SAT-2")
        # The page goes on deciding upon the state in which both began to press.
        one.tab.evaluate(HELD_BACK)
        one.button("hold").click()
        expect(said(one, "hold")).to_contain_text("asked")
    for one in pair:
        one.tab.evaluate("window.go()")
    for one in pair:
        expect(one.tab.locator("#state")).to_have_attribute("data-state", "HELD")
        expect(one.tab.locator("#last-command")).to_contain_text("Hold – anna@panel-1, ")
    _anna, boris = pair
    expect(said(boris, "hold")).to_contain_text("Refused: the cell has changed")
    expect(said(boris, "hold")).to_contain_text("Hold – anna@panel-1, ")
    assert paper.obeyed == [("anna@panel-1", "hold")]
    assert paper.turned_down == [("boris@panel-1", "hold", "SUPERSEDED")]


def test_both_may_stop_and_abort_whatever_the_other_has_pressed(
    pair: tuple[Screen, Screen], paper: JudgingDaemon
) -> None:
    anna, boris = pair
    anna.button("stop").click()
    boris.button("abort").click()
    for one, name in ((anna, "stop"), (boris, "abort")):
        expect(said(one, name)).to_contain_text("taken")
    for one in pair:
        expect(one.tab.locator("#state")).to_have_attribute("data-state", "ABORTED")
    assert sorted(name for _, name in paper.obeyed) == ["abort", "stop"]


def test_one_key_is_one_command_and_a_new_key_of_an_old_look_is_none(
    pair: tuple[Screen, Screen], paper: JudgingDaemon
) -> None:
    anna, boris = pair
    first = anna.tab.evaluate(SENT, ["key-of-anna", 7])
    assert first[0] == 202
    assert anna.tab.evaluate(SENT, ["key-of-anna", 7]) == first
    status, problem = anna.tab.evaluate(SENT, ["another-key", 7])
    assert (status, problem["reject_code"]) == (412, RejectCode.SUPERSEDED)
    status, _problem = boris.tab.evaluate(SENT, ["key-of-anna", 8])
    assert status == 502, "a key belongs to one person"
    assert paper.obeyed == [("anna@panel-1", "hold")]


def test_a_reload_in_mid_run_shows_the_same_and_sends_nothing(
    pair: tuple[Screen, Screen], paper: JudgingDaemon
) -> None:
    anna, _boris = pair
    path = "document.querySelector('.curve path').getAttribute('d').length"
    anna.tab.wait_for_timeout(1500)
    before = anna.tab.evaluate(path)
    anna.tab.reload()
    expect(anna.tab.locator("#state")).to_have_attribute("data-state", "EXECUTE")
    expect(anna.tab.locator("#now")).to_contain_text("SAT-2")
    expect(anna.tab.locator("#step")).to_contain_text("mate")
    expect(anna.tab.locator("#who")).to_contain_text("anna")
    expect(anna.button("hold")).to_be_enabled()
    assert anna.tab.evaluate(path) >= before, "the curve was kept"
    assert paper.asked == []


def test_a_session_that_was_ended_elsewhere_is_told_at_the_first_press(
    pair: tuple[Screen, Screen], paper: JudgingDaemon
) -> None:
    anna, _boris = pair
    other = anna.tab.context.new_page()
    other.goto(anna.url)
    expect(other.locator("#who")).to_contain_text("anna")
    other.click("#who")
    expect(other.locator("#who")).to_contain_text("Sign in")
    anna.button("hold").click()
    expect(said(anna, "hold")).to_contain_text("your role does not allow it")
    expect(anna.tab.locator("#who")).to_contain_text("Sign in")
    expect(anna.button("unhold")).to_be_disabled()
    assert paper.obeyed == []


def test_a_page_process_that_froze_or_was_started_again_is_told_at_once(
    tabs: Tabs, settings: Path, paper: JudgingDaemon
) -> None:
    with (
        serving(settings.parent / "s", paper),
        page_process(settings) as (process, url),
        Screen(tabs, url) as screen,
    ):
        tab = screen.tab
        screen.sign_in()
        process.send_signal(signal.SIGSTOP)
        try:
            expect(tab.locator("#band")).to_contain_text("NO CONNECTION TO THE CELL")
        finally:
            process.send_signal(signal.SIGCONT)
        expect(tab.locator("#age")).to_contain_text("live", timeout=10_000)
        expect(tab.locator("#who")).to_contain_text("anna")
        process.kill()
        process.wait(10)
        expect(tab.locator("#band")).to_contain_text("NO CONNECTION TO THE CELL")
        port = url.rstrip("/").rsplit(":", 1)[1]
        settings.write_text(settings.read_text().replace("port = 0", f"port = {port}"))
        with page_thread(settings):
            expect(tab.locator("#age")).to_contain_text("live", timeout=10_000)
            expect(tab.locator("#who")).to_contain_text("Sign in")
            expect(screen.button("hold")).to_be_disabled()
            expect(screen.button("abort")).to_be_enabled()


def test_whoever_was_idle_signs_in_again_without_signing_out(screen: Screen) -> None:
    screen.sign_in()
    idle = session_told(Visitor("anna", "view", "panel-1", ""), "en").model_dump() | {"idle": True}
    screen.tab.route("**/api/v1/session", lambda route: route.fulfill(json=idle))
    screen.tab.reload()
    expect(screen.tab.locator("#who")).to_contain_text(re.compile("anna.*idle"))
    expect(said(screen, "unhold")).to_contain_text("sign in again")
    screen.tab.click("#who")
    # Only now: who asks the page's process sooner is told that anna is there, and would sign out.
    screen.tab.unroute_all()
    screen.fill_in()
    expect(screen.button("unhold")).to_be_enabled()
