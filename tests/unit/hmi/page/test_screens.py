"""The page in a real Chromium, before a daemon made of paper."""

import re

from playwright.sync_api import expect

from cellctl.api.local_socket.messages import (
    AcknowledgeCommand,
    PlainCommand,
    Refused,
    StartCommand,
)
from cellctl.fault_catalogue import known_fault
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.translations import fault_words, label
from tests.unit.hmi.page.screen import MOTION, Screen
from tests.unit.hmi.scripted_daemon import NAMES, PaperDaemon, alarm, snapshot

STATES = [state.name for state in State if state.name != "UNDEFINED"]


def test_every_state_has_its_word_in_both_languages(screen: Screen, paper: PaperDaemon) -> None:
    state = screen.tab.locator("#state")
    for language in ("en", "zh"):
        words = set()
        for name in STATES:
            paper.snapshot = snapshot(state=name, state_requested=name)
            expect(state).to_have_attribute("data-state", name)
            words.add(state.inner_text())
        assert len(words) == len(STATES)
        assert any(word.isascii() for word in words) == (language == "en")
        screen.tab.click("#language")
    paper.snapshot = snapshot(state="ABORTED", state_requested="ABORTED")
    expect(state).to_contain_text("■")


def test_buttons_are_what_the_cell_permits_with_its_reasons(
    screen: Screen, paper: PaperDaemon
) -> None:
    expect(screen.button("start")).to_be_disabled()
    expect(screen.button("abort")).to_be_enabled()
    screen.sign_in()
    for name in ("start", "reset", "hold", "unhold", "clear", "stop", "abort"):
        expect(screen.button(name)).to_be_enabled()
    code = RejectCode.LINE_IN_CONTROL
    refused = {name: {"code": int(code), "reason": code.text} for name in NAMES}
    paper.snapshot = snapshot(permitted=refused)
    for name in (*MOTION, "hold", "clear"):
        expect(screen.button(name)).to_be_disabled()
        expect(screen.tab.locator(f"[data-command={name}] small")).to_contain_text("line PLC")
    for name in ("stop", "abort"):
        expect(screen.button(name)).to_be_enabled()


def test_what_moves_the_cell_is_pressed_for_a_second(screen: Screen, paper: PaperDaemon) -> None:
    screen.sign_in()
    screen.press(screen.button("reset"), 0.4)
    assert paper.asked == []
    screen.press(screen.button("reset"), 1.4)
    assert [asked.command for asked in paper.asked] == [PlainCommand(request="reset")]
    screen.button("unhold").focus()
    screen.tab.keyboard.down("Enter")
    screen.tab.wait_for_timeout(1400)
    screen.tab.keyboard.up("Enter")
    assert paper.asked[-1].command == PlainCommand(request="unhold")
    assert paper.asked[-1].on_behalf.decision == 7
    screen.button("stop").focus()
    screen.tab.keyboard.press("Enter")
    expect(screen.tab.locator("[data-command=stop] small")).to_contain_text("taken")
    assert paper.asked[-1].command == PlainCommand(request="stop"), "one press, no dialog"


def test_a_hold_says_what_it_waits_for(screen: Screen, paper: PaperDaemon) -> None:
    screen.sign_in()
    said, following = screen.tab.locator("#said-hold"), screen.tab.locator("#next")
    running = {"state": "EXECUTE", "state_requested": "EXECUTE"}
    paper.snapshot = snapshot(**running)
    expect(said).to_contain_text("at the next point where it can go on")
    paper.snapshot = snapshot(**running, safe_point_ahead=False)
    expect(said).to_contain_text("Too late")
    expect(screen.button("hold")).to_be_enabled()
    paper.snapshot = snapshot(**running, hold_requested=True)
    expect(following).to_contain_text("it waits for the next point")
    paper.snapshot = snapshot(**running, hold_requested=True, safe_point_ahead=False)
    expect(following).to_contain_text("comes too late")


def test_a_start_names_serial_and_recipe(screen: Screen, paper: PaperDaemon) -> None:
    screen.sign_in()
    screen.button("start").click()
    go = screen.tab.locator("dialog .row button").first
    screen.press(go, 1.4)
    assert paper.asked == [], "without a serial number nothing starts"
    screen.tab.fill("#serial", "SAT-0042")
    screen.press(go, 1.4)
    expect(screen.tab.locator("[data-command=start] small")).to_contain_text("taken")
    assert paper.asked[0].command == StartCommand(serial="SAT-0042", recipe="1")


def test_a_refusal_and_a_missing_answer_are_told(screen: Screen, paper: PaperDaemon) -> None:
    screen.sign_in()
    code = RejectCode.SUPERSEDED
    paper.answer = Refused(code=code, text=code.text, state="IDLE")
    screen.button("hold").click()
    said = screen.tab.locator("[data-command=hold] small")
    expect(said).to_contain_text("the cell has changed")
    paper.holds_back = True
    screen.button("abort").click()
    expect(screen.tab.locator("[data-command=abort] small")).to_contain_text("asked")
    expect(screen.tab.locator("[data-command=abort] small")).to_contain_text("NO ANSWER")
    assert screen.tab.locator("#state").get_attribute("data-state") == "IDLE"
    assert len(paper.asked) == 2, "never repeated by itself"


def test_a_silent_daemon_makes_the_page_stale_and_it_comes_back(
    screen: Screen, paper: PaperDaemon
) -> None:
    screen.sign_in()
    paper.silent = True
    expect(screen.tab.locator("#band")).to_contain_text("NO CONNECTION TO THE CELL")
    for name in MOTION:
        expect(screen.button(name)).to_be_disabled()
    for name in ("stop", "abort"):
        expect(screen.button(name)).to_be_enabled()
    for shown in (".live", "#next"):
        struck = f"getComputedStyle(document.querySelector('{shown}')).textDecorationLine"
        assert screen.tab.evaluate(struck) == "line-through", shown
    paper.silent = False
    expect(screen.tab.locator("#band")).to_be_empty()
    expect(screen.button("reset")).to_be_enabled()


def test_an_alarm_moves_no_button_and_is_acknowledged(screen: Screen, paper: PaperDaemon) -> None:
    screen.sign_in()
    before = screen.button("abort").bounding_box()
    first, later = alarm(512, "force limit"), alarm(635, "invalidated", "warn")
    paper.snapshot = snapshot(faults=[first], alarms=[later, first])
    expect(screen.tab.locator("#band")).to_contain_text("■1 F512")
    assert screen.button("abort").bounding_box() == before
    screen.tab.click("nav a[href='#alarms']")
    alarms = screen.tab.locator(".alarm")
    expect(alarms).to_have_count(2)
    expect(alarms.first).to_contain_text("F512")
    expect(alarms.first).to_contain_text("a remedy")
    with screen.tab.expect_response(re.compile("/api/v1/commands")):
        alarms.first.get_by_role("button").click()
    assert paper.asked[-1].command.request == "acknowledge"


def test_an_alarm_that_came_again_is_acknowledged_as_often_as_it_was_shown(
    screen: Screen, paper: PaperDaemon
) -> None:
    screen.sign_in()
    again = alarm(207, "too old", "warn") | {"times": 3, "newest": "2026-01-02T03:09:05+00:00"}
    paper.snapshot = snapshot(alarms=[again])
    screen.tab.click("nav a[href='#alarms']")
    expect(screen.tab.locator(".alarm")).to_contain_text("came 3 times, the last time at")
    button = screen.tab.locator(".alarm button").element_handle()
    paper.snapshot = snapshot(alarms=[again | {"times": 4}])
    expect(screen.tab.locator(".alarm")).to_contain_text("came 4 times")
    assert button.evaluate("element => element.isConnected"), "it stays under the finger"
    with screen.tab.expect_response(re.compile("/api/v1/commands")):
        button.click()
    assert paper.asked[-1].command == AcknowledgeCommand(number=207, seen=4)


def test_the_band_names_every_alarm_and_the_gravest_first(
    screen: Screen, paper: PaperDaemon
) -> None:
    silent = alarm(701, "Line PLC silent: 3.0 s") | {"reaction": "stop"}
    told = "A run was not closed before the daemon ended: run 7"
    left = alarm(821, told) | {"reaction": "warn"}
    paper.snapshot = snapshot(faults=[silent], alarms=[silent, left])
    band = screen.tab.locator("#band")
    expect(band).to_contain_text("▲2 F701")
    expect(band).to_contain_text("· ▼3 F821 A run was not closed before the daemon ended")
    expect(band).not_to_contain_text("run 7")
    touched = alarm(512, "Force limit exceeded: Fz 61 N") | {"reaction": "abort"}
    paper.snapshot = snapshot(faults=[silent, touched], alarms=[silent, touched])
    expect(band).to_contain_text("■1 F512")
    expect(band).to_contain_text("· ▲2 F701")
    expect(band).to_have_class("p1")


def test_an_alarm_and_a_step_are_told_in_chinese(screen: Screen, paper: PaperDaemon) -> None:
    old = known_fault(207)
    assert old is not None
    chinese = fault_words(old, "zh")
    told = alarm(207, f"{old.text}: 0.31 s") | {"cause": old.cause, "remedy": old.remedy}
    step = {"number": 50, "label": "mate", "text": "head_1: view 2 of 3"}
    paper.snapshot = snapshot(alarms=[told, alarm(1999, "of a plug-in")], step=step)
    band, tab = screen.tab.locator("#band"), screen.tab
    expect(band).to_contain_text(f"F207 {old.text}: 0.31 s")
    tab.click("#language")
    expect(band).to_contain_text(f"F207 {chinese.text}：0.31 s")
    expect(tab.locator("#step")).to_contain_text(label("mate", "zh"))
    expect(tab.locator("#now")).to_contain_text(label("head_1: view 2 of 3", "zh"))
    tab.click("nav a[href='#alarms']")
    alarms = tab.locator(".alarm")
    expect(alarms.first).to_contain_text(f"原因：{chinese.cause}")
    expect(alarms.first).to_contain_text(chinese.remedy)
    expect(alarms.last).to_contain_text("F1999 of a plug-in")
    expect(alarms.last).to_contain_text("a remedy")


def test_a_missing_value_is_a_dash(screen: Screen, paper: PaperDaemon) -> None:
    bare = snapshot()
    bare["forces"][0]["wrench"] = []
    bare["forces"][0]["limit_n"] = None
    paper.snapshot = bare
    expect(screen.tab.locator("#forces .value")).to_have_text("— N / — N")
    expect(screen.tab.locator("#errors td.num").first).to_have_text("— mm")


def test_a_force_of_which_nothing_has_come_is_not_known(screen: Screen, paper: PaperDaemon) -> None:
    old = snapshot()
    unknown = [axis | {"value": None} for axis in old["forces"][0]["wrench"]]
    old["forces"][0] |= {"stale": True, "age_s": 24.9, "wrench": unknown}
    paper.snapshot = old
    expect(screen.tab.locator("#forces")).to_contain_text("not known: the newest value")
    expect(screen.tab.locator("#forces")).to_contain_text("25 s old")
    expect(screen.tab.locator("#forces .value")).to_contain_text("— N")


def test_gloves_find_every_control_of_the_run_screen(screen: Screen) -> None:
    screen.sign_in()
    sizes = screen.tab.evaluate(
        "[...document.querySelectorAll('a, button, input, select')].map((one) => "
        "[one.textContent, one.getBoundingClientRect()]).map(([t, r]) => [t, r.width, r.height])"
    )
    assert len(sizes) >= 14
    assert [one for one in sizes if one[1] < 64 or one[2] < 64] == []
    heights = screen.tab.evaluate(
        "[document.querySelector('.buttons button').getBoundingClientRect().bottom]"
    )
    assert heights[0] < 800, "the commands are seen without scrolling"


def test_all_screens_show_what_there_is(screen: Screen) -> None:
    screen.sign_in("boris")
    tab = screen.tab
    for name, words in {
        "history": "SAT-2",
        "calibration": "101",
        "maintenance": "calibrate head",
        "line": "PackML StateCurrent",
        "health": "shift begins",
        "alarms": "No alarms",
    }.items():
        tab.click(f"nav a[href='#{name}']")
        expect(tab.locator("main")).to_contain_text(words)
    tab.goto(f"{screen.url}#history/1")
    expect(tab.locator("main")).to_contain_text("measure")
    tab.reload()
    expect(tab.locator("main")).to_contain_text("measure")
    expect(tab.locator("#who")).to_contain_text("boris")


def test_from_a_run_to_all_others_that_used_the_same_calibration(screen: Screen) -> None:
    screen.sign_in("boris")
    tab = screen.tab
    tab.goto(f"{screen.url}#history")
    expect(tab.locator("#found tbody tr")).to_have_count(2)
    tab.fill("#find-until", "2001-02-03")
    tab.click("form button")
    expect(tab.locator("#found")).to_contain_text("No runs found.")
    tab.goto(f"{screen.url}#history/1")
    tab.click("text=parts made with it")
    expect(tab.locator("#find-calibration")).to_have_value("id-SAT-1")
    expect(tab.locator("#found tbody tr")).to_have_count(1)
    expect(tab.locator("#found")).to_contain_text("SAT-1")


SIZES = ((1280, 800), (1080, 1920), (1024, 600), (768, 1024))


def test_nothing_is_cut_off_on_any_panel_and_the_commands_stay_in_reach(screen: Screen) -> None:
    screen.sign_in("boris")
    tab, cut = screen.tab, []
    for language in ("en", "zh"):
        for width, height in SIZES:
            tab.set_viewport_size({"width": width, "height": height})
            for name in ("run", "history", "maintenance/101"):
                tab.goto(f"{screen.url}#{name}")
                expect(tab.locator("main section").first).to_be_visible()
                wide = tab.evaluate("document.documentElement.scrollWidth")
                beyond = tab.evaluate(
                    "[...document.querySelectorAll('.third .scroll, header, .buttons button')]"
                    ".filter((one) => one.scrollWidth > one.clientWidth + 1).length"
                )
                head = screen.tab.locator("header").bounding_box()["height"]
                if wide > width or beyond or head > (80 if width >= 1280 else 160):
                    cut.append((language, width, name, wide, beyond, head))
                if name == "run":
                    for command in ("stop", "abort"):
                        seen = screen.button(command).bounding_box()
                        assert seen["y"] + seen["height"] < height
        tab.click("#language")
    assert cut == []
