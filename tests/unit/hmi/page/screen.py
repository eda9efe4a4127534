"""A tab of the page in a real Chromium."""

from typing import Any

from playwright.sync_api import expect

from tests.unit.hmi.scripted_daemon import PIN

SIZE = {"width": 1280, "height": 800}
MOTION = ("start", "reset", "unhold")


STREAMS = """(() => {
    const Source = window.EventSource;
    window.streams = [];
    window.EventSource = class extends Source {
        constructor(...given) { super(...given); window.streams.push(this); }
    };
})()"""


class Tabs:
    """Tabs of one Chromium, each of a person of its own, handed on from test to test.

    A new person costs Chromium more than all that a test shows them.
    """

    def __init__(self, browser: Any) -> None:
        self._browser = browser
        self._idle: list[Any] = []

    def take(self) -> Any:
        """A tab that knows nobody and shows nothing."""
        if self._idle:
            return self._idle.pop()
        context = self._browser.new_context(viewport=SIZE, locale="en-GB", reduced_motion="reduce")
        return context.new_page()

    def give_back(self, tab: Any) -> None:
        """Take away what the test has left in it."""
        for other in tab.context.pages:
            if other is not tab:
                other.close()
        tab.unroute_all()
        tab.evaluate("localStorage.clear()")
        tab.goto("about:blank")
        tab.context.clear_cookies()
        tab.set_viewport_size(SIZE)
        self._idle.append(tab)


class Screen:
    """One tab, and what went wrong in it."""

    def __init__(self, tabs: Tabs, url: str) -> None:
        self._tabs = tabs
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.url = url
        self.tab = tabs.take()
        self.tab.on("pageerror", self._complain)
        self.tab.on("request", self._ask)
        self.tab.goto(url)
        expect(self.tab.locator("#age")).to_contain_text("live", timeout=15_000)

    def _complain(self, error: Any) -> None:
        self.complaints.append(str(error))

    def _ask(self, request: Any) -> None:
        self.requests.append(request.url)

    def __enter__(self) -> "Screen":
        return self

    def __exit__(self, *_: object) -> None:
        self.tab.remove_listener("pageerror", self._complain)
        self.tab.remove_listener("request", self._ask)
        elsewhere = [one for one in self.requests if not one.startswith(self.url)]
        # A tab of which the page complains may be beyond use, and is not handed on.
        assert not self.complaints, self.complaints
        assert not elsewhere, elsewhere
        self._tabs.give_back(self.tab)

    def sign_in(self, name: str = "anna") -> None:
        self.tab.click("#who")
        self.fill_in(name)

    def fill_in(self, name: str = "anna") -> None:
        """The dialog that is open."""
        self.tab.fill("#name", name)
        self.tab.fill("#pin", PIN)
        self.tab.press("#pin", "Enter")
        expect(self.tab.locator("#who")).to_contain_text(name)

    def listen(self) -> None:
        """Load the page anew, with its streams in ``window.streams`` for a test to speak there."""
        self.tab.add_init_script(STREAMS)
        self.tab.reload()
        expect(self.tab.locator("#age")).to_contain_text("live", timeout=15_000)

    def button(self, name: str) -> Any:
        return self.tab.locator(f"#cmd-{name}")

    def press(self, target: Any, seconds: float) -> None:
        target.hover()
        self.tab.mouse.down()
        self.tab.wait_for_timeout(1000 * seconds)
        self.tab.mouse.up()
