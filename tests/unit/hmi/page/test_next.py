"""What the operator is told to do when a run has ended, where the part may hang free."""

import pytest
from playwright.sync_api import expect

from tests.unit.hmi.page.screen import Screen
from tests.unit.hmi.scripted_daemon import PaperDaemon, snapshot


@pytest.mark.parametrize(
    ("result", "words"),
    [
        ("good", "take the part out as the process says"),
        ("bad", "What hangs free: leave its gripper closed."),
    ],
)
def test_a_gripper_is_opened_only_after_a_good_part(
    screen: Screen, paper: PaperDaemon, result: str, words: str
) -> None:
    run = {"number": 2, "serial": "SAT-2", "recipe": 1, "result": result, "good_parts": 4}
    paper.snapshot = snapshot(state="COMPLETED", state_requested="COMPLETED", run=run)
    expect(screen.tab.locator("#next")).to_contain_text(words)
