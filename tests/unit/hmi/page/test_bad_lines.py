"""What the page shows over a slow line and while a cable is out, and that it comes back."""

from playwright.sync_api import expect

from tests.unit.hmi.bad_line import bad_line
from tests.unit.hmi.page.screen import MOTION, Screen, Tabs
from tests.unit.hmi.scripted_daemon import PaperDaemon

NO_CONNECTION = "NO CONNECTION TO THE CELL"


def test_what_comes_steadily_and_late_is_old(tabs: Tabs, address: str) -> None:
    """Events never stop on such a line: a page that watched their arrival would call them live."""
    with bad_line(address) as (line, url), Screen(tabs, url) as screen:
        screen.sign_in()
        line.rate_b_s = 5000.0
        expect(screen.tab.locator("#band")).to_contain_text(NO_CONNECTION, timeout=20_000)
        for name in MOTION:
            expect(screen.button(name)).to_be_disabled()
        expect(screen.button("abort")).to_be_enabled()
        line.rate_b_s = 0.0
        expect(screen.tab.locator("#age")).to_contain_text("live", timeout=20_000)


def test_a_connection_that_died_without_a_word_is_replaced(
    tabs: Tabs, address: str, paper: PaperDaemon
) -> None:
    with bad_line(address) as (line, url), Screen(tabs, url) as screen:
        line.cut = True
        expect(screen.tab.locator("#band")).to_contain_text(NO_CONNECTION, timeout=20_000)
        line.cut = False
        expect(screen.tab.locator("#age")).to_contain_text("live", timeout=30_000)
        # A page whose cell says nothing, but whose process answers, keeps its stream.
        asked = sum(one.endswith("/events") for one in screen.requests)
        paper.silent = True
        expect(screen.tab.locator("#band")).to_contain_text(NO_CONNECTION)
        screen.tab.wait_for_timeout(5000)
        assert sum(one.endswith("/events") for one in screen.requests) == asked
