"""A procedure on the page: set up, started, watched, ended, with what follows."""

from typing import Any

import pytest
from playwright.sync_api import expect

from cellctl.api.local_socket.messages import ProcedureCommand
from cellctl.packml.reject import RejectCode
from cellctl.translations import label
from tests.unit.hmi.page.screen import Screen
from tests.unit.hmi.scripted_daemon import PaperDaemon, alarm, snapshot

RUN = {"number": 41, "serial": "PROCEDURE-101", "recipe": 101, "good_parts": 4}
AT_WORK = {"number": 101, "label": "calibrate head 1", "text": "head_1: view 3 of 20"}


def at(state: str, result: str = "none", **changes: Any) -> dict[str, Any]:
    run = RUN | {"result": result}
    return snapshot(mode="MAINTENANCE", state=state, state_requested=state, run=run, **changes)


@pytest.fixture
def guided(screen: Screen, paper: PaperDaemon) -> Screen:
    paper.snapshot = snapshot(mode="MAINTENANCE")
    screen.sign_in("boris")
    screen.tab.click("nav a[href='#maintenance']")
    screen.tab.click("main a[href='#maintenance/101']")
    expect(screen.tab.locator("#tick-1")).to_be_visible()
    return screen


def current(screen: Screen) -> Any:
    return screen.tab.locator("[data-step][aria-current=step]")


def test_it_starts_when_each_line_of_the_set_up_is_ticked(
    guided: Screen, paper: PaperDaemon
) -> None:
    tab = guided.tab
    expect(current(guided)).to_have_attribute("data-step", "set_up")
    expect(guided.button("procedure")).to_be_disabled()
    expect(tab.locator("[data-command=procedure] small")).to_contain_text("Tick each line")
    expect(tab.locator("[data-step=moves]")).to_contain_text("Nothing else moves.")
    tab.check("#tick-0")
    expect(guided.button("procedure")).to_be_disabled()
    tab.check("#tick-1")
    expect(current(guided)).to_have_attribute("data-step", "start")
    guided.button("procedure").click()
    assert paper.asked == [], "pressed for a second"
    guided.press(guided.button("procedure"), 1.4)
    expect(tab.locator("[data-command=procedure] small")).to_contain_text("taken")
    asked = paper.asked[0]
    assert asked.command == ProcedureCommand(number=101, serial="PROCEDURE-101")
    assert asked.on_behalf.reason == "2 points of the set-up confirmed at the page"


def test_another_mode_is_set_on_the_spot(guided: Screen, paper: PaperDaemon) -> None:
    code = RejectCode.OTHER_MODE
    permitted = snapshot()["permitted"] | {"procedure": {"code": int(code), "reason": code.text}}
    paper.snapshot = snapshot(permitted=permitted)
    guided.tab.check("#tick-0")
    guided.tab.check("#tick-1")
    expect(current(guided)).to_have_attribute("data-step", "ready")
    expect(guided.button("procedure")).to_be_disabled()
    guided.button("mode").click()
    expect(guided.tab.locator("[data-command=mode] small")).to_contain_text("taken")
    assert paper.asked[0].command.request == "mode"


def test_its_progress_and_result_are_those_of_the_cell_on_every_page(
    guided: Screen, paper: PaperDaemon
) -> None:
    tab = guided.tab
    last = {"who": "page:anna@panel-2", "command": "procedure", "time": "2026-01-02T10:03:04Z"}
    paper.snapshot = at("EXECUTE", step=AT_WORK, last_command=last)
    expect(current(guided)).to_have_attribute("data-step", "under_way")
    expect(tab.locator("[role=progressbar]")).to_have_attribute("aria-valuenow", "15")
    expect(tab.locator("#progress")).to_contain_text("Execute: head_1: view 3 of 20")
    expect(tab.locator("[data-step=set_up]")).to_contain_text("under the head")
    expect(tab.locator("#tick-0")).to_be_hidden()
    expect(tab.locator("#who-runs")).to_contain_text("anna@panel-2")
    expect(guided.button("stop")).to_be_enabled()
    tab.click("nav a[href='#run']")
    tab.click("nav a[href='#maintenance']")
    tab.click("main a[href='#maintenance/101']")
    expect(current(guided)).to_have_attribute("data-step", "under_way")
    expect(tab.locator("#tick-0")).to_be_hidden()
    paper.snapshot = at("COMPLETED", "good")
    renewed = {"made": "2027-08-09T03:04:05Z"}
    calibrations = [one | renewed for one in paper.description["calibrations"]]
    paper.description = paper.description | {"calibrations": calibrations}
    expect(current(guided)).to_have_attribute("data-step", "result")
    expect(tab.locator("#outcome")).to_contain_text("Done")
    expect(tab.locator("#tick-0")).to_be_visible()
    expect(tab.locator("#tick-0")).not_to_be_checked()
    expect(tab.locator("#outcome")).to_contain_text("Run 41")
    expect(tab.locator("#renewed")).to_contain_text("2027")
    expect(tab.locator("[data-step=then]")).to_contain_text("Take the board away.")


def test_a_result_out_of_limits_says_what_to_do(guided: Screen, paper: PaperDaemon) -> None:
    fault = alarm(601, "Result out of limits")
    paper.snapshot = at("ABORTED", "aborted", faults=[fault], alarms=[fault])
    expect(guided.tab.locator("#outcome")).to_contain_text("F601 Result out of limits")
    expect(guided.tab.locator("#outcome")).to_contain_text("a remedy")
    paper.snapshot = at("STOPPED", "stopped")
    expect(guided.tab.locator("#outcome")).to_contain_text("stopped")


def test_another_run_is_not_taken_for_the_procedure(guided: Screen, paper: PaperDaemon) -> None:
    paper.snapshot = at("EXECUTE", step=AT_WORK) | {"run": RUN | {"recipe": 102, "result": "none"}}
    expect(guided.tab.locator("#mode-now")).to_contain_text("Execute")
    expect(current(guided)).to_have_attribute("data-step", "set_up")
    expect(guided.tab.locator("#outcome")).to_have_text("—")


def test_sentences_are_told_in_chinese_and_a_plug_in_without_them_has_a_page(
    guided: Screen,
) -> None:
    tab = guided.tab
    tab.click("#language")
    line = "The calibration board lies under the head."
    expect(tab.locator("[data-step=set_up]")).to_contain_text(label(line, "zh"))
    expect(tab.locator("[data-step=set_up]")).to_contain_text("The light is on.")
    tab.click("#language")
    tab.goto(f"{guided.url}#maintenance/900")
    expect(tab.locator("[data-step=set_up]")).to_contain_text("see its documentation")
    expect(guided.button("procedure")).to_be_enabled()
    tab.goto(f"{guided.url}#maintenance/12345")
    expect(tab.locator("main tbody tr")).to_have_count(2)
