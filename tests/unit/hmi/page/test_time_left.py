"""How long a run still takes, where the operator looks first."""

from typing import Any

import pytest
from playwright.sync_api import expect

from tests.unit.hmi.page.screen import Screen
from tests.unit.hmi.scripted_daemon import PaperDaemon, snapshot

RUNNING = {
    "state": "EXECUTE",
    "state_requested": "EXECUTE",
    "run": {"number": 2, "serial": "SAT-2", "recipe": 1, "result": "none", "good_parts": 4},
    "step": {"number": 50, "label": "mate", "text": ""},
}
TOLD = {"number": 50, "step": 5, "of": 7, "left_s": 100.6, "longer": False, "by_runs": 20}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "5 of 7 steps, about 1:41 min left"),
        ({"longer": True}, "5 of 7 steps, this one takes longer than usual"),
    ],
)
def test_the_step_of_all_and_what_is_left_are_told(
    screen: Screen, paper: PaperDaemon, changes: dict[str, Any], words: str
) -> None:
    screen.tab.route("**/time-left", lambda route: route.fulfill(json=TOLD | changes))
    paper.snapshot = snapshot(**RUNNING)
    expect(screen.tab.locator("#left")).to_have_text(words)
    paper.snapshot = snapshot(**RUNNING | {"step": {"number": 60, "label": "seat", "text": ""}})
    expect(screen.tab.locator("#step")).to_contain_text("60")
    expect(screen.tab.locator("#left")).to_have_count(0)
    paper.snapshot = snapshot(**RUNNING)
    expect(screen.tab.locator("#left")).to_have_text(words)
    paper.snapshot = snapshot(**RUNNING | {"state": "HELD"})
    expect(screen.tab.locator("#left")).to_have_count(0)


def test_without_a_good_run_of_the_recipe_no_time_is_told(
    screen: Screen, paper: PaperDaemon
) -> None:
    with screen.tab.expect_response("**/runs/2/time-left") as asked:
        paper.snapshot = snapshot(**RUNNING)
    assert asked.value.status == 200
    expect(screen.tab.locator("#step")).to_contain_text("mate")
    expect(screen.tab.locator("#left")).to_have_count(0)


def test_on_a_low_panel_what_is_to_be_done_stays_in_sight(
    screen: Screen, paper: PaperDaemon
) -> None:
    screen.tab.set_viewport_size({"width": 1024, "height": 600})
    screen.tab.route("**/time-left", lambda route: route.fulfill(json=TOLD))
    paper.snapshot = snapshot(**RUNNING)
    expect(screen.tab.locator("#left")).to_be_visible()
    end, commands = screen.tab.evaluate(
        "['#next', '.commands'].map((one) => document.querySelector(one).getBoundingClientRect())"
        ".map((one, i) => i ? one.top : one.bottom)"
    )
    assert end <= commands
