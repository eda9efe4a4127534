"""Records on the page: past alarms, what stands behind a part, calibrations over the years."""

import re
import sqlite3
from contextlib import closing
from pathlib import Path

from playwright.sync_api import expect

from cellctl.api.local_socket.messages import StartCommand
from cellctl.records.database.schema_version import FILE
from tests.unit.hmi.page.screen import SIZE, Screen
from tests.unit.hmi.scripted_daemon import PaperDaemon, alarm, snapshot

LINES = """(place) => {
    const text = document.createRange();
    text.selectNodeContents(place);
    return new Set([...text.getClientRects()].map((one) => Math.round(one.top))).size;
}"""
MATING = {"number": 50, "label": "mate", "text": ""}


def test_past_alarms_say_when_and_by_whom_they_were_acknowledged(
    screen: Screen, paper: PaperDaemon
) -> None:
    tab = screen.tab
    tab.click("nav a[href='#alarms']")
    past = tab.locator("#past")
    expect(past.locator("tbody tr")).to_have_count(3)
    expect(past.locator("tbody tr").first).to_contain_text("nobody yet")
    expect(past.locator("tbody tr").last).to_contain_text("anna@panel-1")
    expect(past).to_contain_text("In the last hour: 3")
    # A new one that the cell tells of is looked up: the list does not wait for a visit.
    with tab.expect_response(re.compile("/api/v1/alarms")):
        paper.snapshot = snapshot(alarms=[alarm(304, "It did not stop")])
    tab.click("#language")
    expect(past).to_contain_text("最近一小时")
    expect(past.locator("tbody tr").last).to_contain_text("-50.8 N")


def test_modes_procedures_and_commands_are_told_in_chinese(screen: Screen) -> None:
    tab = screen.tab
    tab.click("#language")
    tab.goto(f"{screen.url}#history")
    runs = tab.locator("#found tbody tr")
    expect(runs.first).to_contain_text("生产")
    screen.sign_in("boris")
    tab.goto(f"{screen.url}#health")
    expect(tab.locator("#audit")).to_contain_text("复位")
    expect(tab.locator("#audit")).to_contain_text("启动 维护程序 101")
    expect(tab.locator("#audit")).to_contain_text("标定测头 1")
    expect(tab.locator("#audit")).to_contain_text("F512")


def test_a_mode_and_a_refusal_are_told_whole(screen: Screen) -> None:
    tab = screen.tab
    screen.sign_in("boris")
    tab.goto(f"{screen.url}#health")
    refused, taken = tab.locator("#audit tbody tr").nth(0), tab.locator("#audit tbody tr").nth(1)
    expect(taken).to_contain_text("Mode Maintenance")
    expect(taken).not_to_contain_text("Refused")
    expect(refused).to_contain_text("Mode Manual")
    expect(refused).to_contain_text("a look · ■ Refused: your role does not allow it")


def test_a_day_is_shown_as_all_dates_are_and_a_wrong_one_is_called_so(screen: Screen) -> None:
    tab = screen.tab
    tab.goto(f"{screen.url}#history")
    since, until = tab.locator("#find-since"), tab.locator("#find-until")
    expect(tab.locator("#found tbody tr")).to_have_count(2)
    since.fill("2026-02-03")
    expect(tab.locator("#day-since")).to_have_text("2026-02-03")
    until.fill("2026-02-01")
    tab.click("form button")
    message = "element => element.validationMessage"
    assert until.evaluate(message) == "This day is before the first one."
    since.fill("2000-01-01")
    tab.click("form button")
    expect(tab.locator("#found")).to_contain_text("No runs found.")
    tab.click("#language")
    expect(tab.locator("form button")).to_have_text("搜索")
    # Half of a day, which only a keyboard can write.
    tab.locator("#find-since").press_sequentially("31")
    tab.click("form button")
    assert tab.locator("#find-since").evaluate(message).startswith("请填写日历上有的日期")


def test_a_start_tells_of_an_earlier_run_of_this_serial_number(screen: Screen) -> None:
    tab = screen.tab
    screen.sign_in()
    screen.button("start").click()
    before = tab.locator("#used-before")
    expect(tab.locator("dialog")).to_contain_text("Calibrations are valid until 2036-01-02")
    tab.fill("#serial", "SAT-2")
    tab.locator("#serial").press("Tab")
    expect(before).to_contain_text("run 2, aborted")
    tab.fill("#serial", "SAT-22")
    tab.locator("#serial").press("Tab")
    expect(before).to_be_empty()


def test_a_dry_run_is_not_said_to_assemble(screen: Screen, paper: PaperDaemon) -> None:
    screen.sign_in()
    screen.button("start").click()
    dialog = screen.tab.locator("dialog")
    expect(dialog).to_contain_text("Robots measure and assemble.")
    screen.tab.check("#dry")
    expect(dialog).to_contain_text("Nothing is assembled.")
    expect(dialog).not_to_contain_text("measure and assemble")
    screen.tab.fill("#serial", "SAT-0042")
    screen.press(dialog.locator(".row button").first, 1.4)
    expect(screen.tab.locator("[data-command=start] small")).to_contain_text("taken")
    assert paper.asked[0].command == StartCommand(serial="SAT-0042", recipe="1", dry_run=True)


def test_limits_have_their_unit(screen: Screen) -> None:
    screen.tab.goto(f"{screen.url}#history/1")
    row = screen.tab.locator("main tbody tr", has_text="greatest force")
    expect(row.locator("td").nth(1)).to_have_text("41.500 N")
    expect(row.locator("td").nth(2)).to_have_text("≤ 50.000 N")


def test_what_rounds_to_zero_has_no_sign(screen: Screen, paper: PaperDaemon) -> None:
    error = {"axis": "x", "unit": "mm", "value": -0.0002, "limit": 0.05}
    paper.snapshot = snapshot(errors=[error, error | {"value": -0.0006}])
    values = screen.tab.locator("#errors tbody td:nth-child(2)")
    expect(values).to_have_text(["0.000 mm", "-0.001 mm"])


def test_an_error_is_told_apart_from_its_limit_and_says_of_which_pass_it_is(
    screen: Screen, paper: PaperDaemon
) -> None:
    error = {"axis": "rx", "unit": "°", "value": 0.0058, "limit": 0.0057}
    paper.snapshot = snapshot(errors=[error], step=MATING, state="EXECUTE") | {"pass": 3}
    cells = screen.tab.locator("#errors tbody td")
    expect(cells).to_have_text(["rx", "0.0058 °", "0.0057", ""])
    heading = screen.tab.locator("#deviation h2")
    expect(heading).to_have_text("Error against limit · pass 3")
    expect(screen.tab.locator("#step")).to_have_text("Step 50: mate · pass 3")
    paper.snapshot = paper.snapshot | {"pass": 0}
    expect(heading).to_have_text("Error against limit · last pass")
    expect(screen.tab.locator("#step")).to_have_text("Step 50: mate")
    paper.snapshot = paper.snapshot | {"errors": [error | {"value": None, "limit": None}]}
    expect(heading).to_have_text("Error against limit")


def test_an_alarm_has_the_colour_of_its_priority(screen: Screen, paper: PaperDaemon) -> None:
    alarms = [alarm(512, "Force limit exceeded"), alarm(635, "warns", reaction="warn")]
    paper.snapshot = snapshot(alarms=alarms)
    screen.tab.goto(f"{screen.url}#alarms")
    stripes = screen.tab.locator(".alarm")
    expect(stripes.first).to_have_css("border-left-color", "rgb(166, 15, 20)")
    expect(stripes.last).to_have_css("border-left-color", "rgb(68, 73, 78)")


def test_a_force_is_drawn_against_its_limit_on_either_side(
    screen: Screen, paper: PaperDaemon
) -> None:
    expect(screen.tab.locator("svg.curve line")).to_have_count(1)
    (force,) = snapshot()["forces"]
    pressed = {"axis": "Fz", "unit": "N", "value": -61.0, "limit": None}
    paper.snapshot = snapshot(forces=[force | {"wrench": [pressed]}])
    expect(screen.tab.locator("svg.curve line")).to_have_count(2)


def test_that_an_arm_may_press_moves_no_button(screen: Screen, paper: PaperDaemon) -> None:
    screen.sign_in()
    (force,) = snapshot()["forces"]
    run = {"number": 17, "serial": "SAT-0042-ABCDEFGHIJKLMNOP", "recipe": 1, "result": "aborted"}
    told = {"state": "ABORTED", "state_requested": "ABORTED", "run": run | {"good_parts": 12345}}
    for _language in ("en", "zh"):
        paper.snapshot = snapshot(**told)
        expect(screen.tab.locator("#state")).to_have_attribute("data-state", "ABORTED")
        expect(screen.tab.locator(".pressing")).to_have_count(0)
        before = screen.button("abort").bounding_box()
        trip = {"presses_n": 101.1, "trip": "RAW_LIMIT Fz -101.1 N, limit 50.0 N"}
        paper.snapshot = snapshot(**told, forces=[force | trip])
        expect(screen.tab.locator(".pressing")).to_be_visible()
        assert screen.button("abort").bounding_box() == before
        assert before["y"] + before["height"] < SIZE["height"]
        screen.tab.click("#language")


def test_however_many_alarms_there_are_the_band_cuts_none_off_at_its_edge(
    screen: Screen, paper: PaperDaemon
) -> None:
    detail = "head_1, frame server 127.0.0.1:26259: no complete reply within 60 s"
    silent = alarm(205, f"Device did not reply in time: {detail}")
    warned = alarm(635, "payload invalidated, for a force limit was exceeded", reaction="warn")
    paper.snapshot = snapshot(alarms=[warned, alarm(512, "Force limit exceeded"), silent])
    lines = screen.tab.locator("#band span")
    for width in (1280, 768):
        screen.tab.set_viewport_size({"width": width, "height": 1024})
        expect(lines.first).to_contain_text("■1 F512")
        expect(lines.last).to_contain_text("▼3 F635")
        band = screen.tab.locator("#band").bounding_box()
        for line in lines.all():
            box = line.bounding_box()
            assert box["y"] >= band["y"]
            assert box["y"] + box["height"] <= band["y"] + band["height"]


def test_the_days_of_a_procedure_s_calibrations_are_whole(
    screen: Screen, paper: PaperDaemon
) -> None:
    problem = "F602 Calibration has expired: head on 2026-10-01"
    one = paper.description["calibrations"][0] | {"problem": problem}
    paper.description = paper.description | {"calibrations": [one]}
    days = screen.tab.locator("#renewed tbody td:nth-child(2)")
    for width in (1280, 1024):
        screen.tab.set_viewport_size({"width": width, "height": 800})
        screen.tab.goto(f"{screen.url}#maintenance/101")
        expect(days).to_contain_text("2026-01-02")
        wide, seen = screen.tab.locator("#renewed .scroll").evaluate(
            "(one) => [one.scrollWidth, one.clientWidth]"
        )
        assert wide <= seen + 1
        assert days.evaluate(LINES) <= 3, "the day, the hour and its zone"


def test_health_says_which_mode_the_cell_has(screen: Screen, paper: PaperDaemon) -> None:
    paper.snapshot = snapshot(mode="MAINTENANCE")
    screen.sign_in("boris")
    screen.tab.goto(f"{screen.url}#health")
    expect(screen.tab.locator("#mode-now")).to_contain_text("Maintenance")
    pressed = screen.tab.locator("button.mode[aria-pressed=true]")
    expect(pressed).to_have_text("Maintenance")
    paper.snapshot = snapshot(mode="MANUAL")
    expect(pressed).to_have_text("Manual")


def test_a_register_without_a_value_shows_a_dash(screen: Screen) -> None:
    screen.tab.goto(f"{screen.url}#line")
    expect(screen.tab.locator("#from-cell tbody tr").last).to_contain_text("—")
    expect(screen.tab.locator("#from-cell")).not_to_contain_text("null")


def test_heads_of_past_alarms_are_whole_on_an_upright_panel(screen: Screen) -> None:
    """Chinese has no spaces: a head may otherwise break behind every character."""
    tab = screen.tab
    tab.set_viewport_size({"width": 768, "height": 1024})
    tab.click("#language")
    tab.goto(f"{screen.url}#alarms")
    head = tab.locator("#past thead th").last
    expect(head).to_have_text("确认时间")
    box = head.bounding_box()
    assert box["width"] > 1.5 * 4 * 10


def test_what_stands_behind_a_part(screen: Screen) -> None:
    tab = screen.tab
    tab.goto(f"{screen.url}#history/1")
    expect(tab.locator("main")).to_contain_text("as it was sealed")
    tab.click("text=What stands behind this part")
    behind = tab.locator("#behind")
    expect(behind).to_contain_text("What stands behind SAT-1")
    expect(behind.locator("tbody tr")).to_have_count(1)
    expect(behind).to_contain_text("not in these records")
    behind.locator("text=id-SAT-1").click()
    expect(tab.locator("#find-calibration")).to_have_value("id-SAT-1")


def test_a_run_that_was_changed_is_told_as_such(screen: Screen, settings: Path) -> None:
    database = sqlite3.connect(settings.parent / "store" / FILE)
    with closing(database), database:
        database.execute("UPDATE runs SET operator = 'somebody else' WHERE number = 1")
    screen.tab.goto(f"{screen.url}#history/1")
    expect(screen.tab.locator("main .bad")).to_contain_text("changed after it was sealed")


def test_the_figures_of_a_calibration_over_the_years(screen: Screen) -> None:
    tab = screen.tab
    tab.click("nav a[href='#calibration']")
    tab.click("#calibrations td a[href='#calibration/head']")
    figures = tab.locator("#trend tbody tr")
    expect(figures).to_have_count(1)
    expect(figures.locator("td")).to_have_text(["residual", "0.120", "■ 0.210", "≤ 0.200 px"])
    expect(tab.locator("#trend thead")).to_contain_text("2025-01-02")
    tab.click("text=All calibrations")
    expect(tab.locator("#calibrations")).to_be_visible()


def test_health_says_no_more_of_a_device_than_that_it_answers(
    screen: Screen, paper: PaperDaemon
) -> None:
    lost = alarm(205, "ends a motion without a reason")
    paper.snapshot = snapshot(state="ABORTED", state_requested="ABORTED", alarms=[lost])
    screen.tab.goto(f"{screen.url}#health")
    state = screen.tab.locator("#links tr", has_text="robots.main").locator("td").nth(1)
    for said in ("answers", "有应答"):
        expect(state).to_have_text(said)
        screen.tab.click("#language")
