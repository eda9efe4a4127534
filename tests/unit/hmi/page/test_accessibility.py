"""Every view and state of the page under axe, which holds it against the rules of WCAG."""

import re
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from cellctl.api.local_socket.messages import Refused
from cellctl.packml.reject import RejectCode
from tests.rigs.sweeps import sweep
from tests.unit.hmi.page.screen import Screen
from tests.unit.hmi.scripted_daemon import PaperDaemon, alarm, snapshot

AXE = Axe().axe_script
# All rules that axe has on by itself, and the one for the size of targets of WCAG 2.2.
OPTIONS = {"resultTypes": ["violations"], "rules": {"target-size": {"enabled": True}}}


def complaints(screen: Screen) -> list[str]:
    """What axe finds wrong with what the tab shows."""
    # Half a megabyte of script, which stays while the page only goes from screen to screen.
    if not screen.tab.evaluate("'axe' in window"):
        screen.tab.evaluate(AXE)
    found: dict[str, Any] = screen.tab.evaluate("(options) => axe.run(options)", OPTIONS)
    assert found["testEngine"]["name"] == "axe-core"
    assert len(found["passes"]) > 20, "it has looked at something"
    return [
        f"{one['id']}: {node['html']} {node['failureSummary']}"
        for one in found["violations"]
        for node in one["nodes"]
    ]


@pytest.fixture(params=sweep(("en", "zh"), ("en",)))
def told(screen: Screen, request: pytest.FixtureRequest) -> Screen:
    """A page whose reader may do everything, in each language; the Chinese ones are figures."""
    if request.param == "zh":
        screen.tab.click("#language")
    expect(screen.tab.locator("html")).to_have_attribute("lang", request.param)
    screen.sign_in("boris")
    return screen


def test_every_screen_of_a_cell_at_rest(told: Screen) -> None:
    found = []
    for name, shows in {
        "run": "#cmd-start",
        "alarms": "#past tbody tr",
        "history": "#found tbody tr",
        "history/1": "figure img",
        "history/behind=SAT-1": "#behind tbody tr",
        "calibration": "#calibrations tbody tr",
        "calibration/head": "#trend tbody tr",
        "maintenance": "tbody tr",
        "maintenance/101": "#cmd-procedure",
        "line": "#from-cell tbody tr",
        "health": "#audit tbody tr",
    }.items():
        told.tab.goto(f"{told.url}#{name}")
        expect(told.tab.locator(shows).first).to_be_visible()
        found += [f"{name} {one}" for one in complaints(told)]
    assert found == []


def test_the_run_and_its_alarms_in_every_kind_of_state(told: Screen, paper: PaperDaemon) -> None:
    faults = [alarm(512, "force limit"), alarm(635, "payload", "warn"), alarm(207, "old", "hold")]
    pressed = snapshot()["forces"][0] | {"trip": "Fz", "presses_n": 12.0, "compensated": False}
    running = {
        "step": {"number": 50, "label": "mate", "text": "pass"},
        "run": {"number": 2, "serial": "SAT-2", "recipe": 1, "result": "none", "good_parts": 4},
        "errors": [{"axis": "x", "unit": "mm", "value": 0.5, "limit": 0.1}],
    }
    code = RejectCode.LINE_IN_CONTROL
    refused = {
        "permitted": {n: {"code": int(code), "reason": code.text} for n in ("reset", "hold")}
    }
    found = []
    states: dict[str, dict[str, Any]] = {
        "EXECUTE": running,
        "HELD": {"alarms": faults[2:], "faults": faults[2:]},
        "ABORTED": running | refused | {"alarms": faults, "faults": faults, "forces": [pressed]},
        "STOPPED": {"alarms": faults[1:2], "forces": []},
        "IDLE": {"stop_not_confirmed": True, "links": {"robots.main": "F201 Link to a robot: no"}},
    }
    for name, state in states.items():
        paper.snapshot = snapshot(state=name, state_requested=name, **state)
        told.tab.goto(f"{told.url}#run")
        expect(told.tab.locator("#state")).to_have_attribute("data-state", name)
        found += [f"{name} {one}" for one in complaints(told)]
        # Every kind of alarm; with none the screen was looked at while the cell was at rest.
        if name in {"ABORTED", "STOPPED"}:
            told.tab.goto(f"{told.url}#alarms")
            expect(told.tab.locator(".alarm")).to_have_count(len(state["alarms"]))
            found += [f"{name} alarms {one}" for one in complaints(told)]
    assert found == []


def test_dialogs_answers_and_old_values(told: Screen, paper: PaperDaemon) -> None:
    found, tab = [], told.tab
    tab.click("#cmd-start")
    expect(tab.locator("dialog")).to_be_visible()
    found += complaints(told)
    tab.keyboard.press("Escape")
    paper.answer = Refused(code=RejectCode.SUPERSEDED, text="changed", state="IDLE")
    tab.click("#cmd-hold")
    expect(tab.locator("[data-command=hold] small")).to_contain_text(
        re.compile("cell has changed|单元状态已变化")
    )
    found += complaints(told)
    paper.silent = True
    expect(tab.locator("body")).to_have_class("stale")
    found += complaints(told)
    for name in ("alarms", "line", "health", "calibration", "maintenance/101"):
        tab.goto(f"{told.url}#{name}")
        found += complaints(told)
    tab.click("#who")
    expect(tab.locator("#who")).not_to_contain_text("boris")
    tab.click("#who")
    expect(tab.locator("#pin")).to_be_visible()
    found += complaints(told)
    assert found == []


def test_tab_goes_by_the_screens_to_the_commands_that_are_permitted(
    screen: Screen, paper: PaperDaemon
) -> None:
    screen.sign_in()
    code = RejectCode.LINE_IN_CONTROL
    refused = {
        name: {"code": int(code), "reason": code.text} for name in ("start", "reset", "clear")
    }
    paper.snapshot = snapshot(permitted=snapshot()["permitted"] | refused)
    screen.tab.reload()
    expect(screen.button("reset")).to_be_disabled()
    expect(screen.button("hold")).to_be_enabled()
    seen = []
    for _ in range(13):
        screen.tab.keyboard.press("Tab")
        seen.append(
            screen.tab.evaluate(
                "document.activeElement.getAttribute('href') || document.activeElement.id"
            )
        )
    screens = ["#run", "#alarms", "#history", "#calibration", "#maintenance", "#line", "#health"]
    assert seen == [*screens, "who", "language", "cmd-hold", "cmd-unhold", "cmd-stop", "cmd-abort"]


def test_whoever_goes_by_key_keeps_their_place_while_the_page_renews_itself(
    screen: Screen,
) -> None:
    screen.tab.focus("nav a[href='#health']")
    screen.tab.evaluate("dispatchEvent(new HashChangeEvent('hashchange'))")
    assert screen.tab.evaluate("document.activeElement.getAttribute('href')") == "#health"
