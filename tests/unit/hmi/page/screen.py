"""A tab of the page in a real Chromium."""

from typing import Any

from playwright.sync_api import expect

from tests.unit.hmi.scripted_daemon import PIN

MOTION = ("start", "reset", "unhold")


class Screen:
    """One tab, and what went wrong in it."""

    def __init__(self, browser: Any, url: str) -> None:
        self.context = browser.new_context(
            viewport={"width": 1280, "height": 800}, locale="en-GB", reduced_motion="reduce"
        )
        self.tab = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.tab.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.tab.on("request", lambda request: self.requests.append(request.url))
        self.url = url
        self.tab.goto(url)
        expect(self.tab.locator("#age")).to_contain_text("live", timeout=15_000)

    def __enter__(self) -> "Screen":
        return self

    def __exit__(self, *_: object) -> None:
        self.context.close()
        assert not self.complaints, self.complaints
        elsewhere = [one for one in self.requests if not one.startswith(self.url)]
        assert not elsewhere, elsewhere

    def sign_in(self, name: str = "anna") -> None:
        self.tab.click("#who")
        self.tab.fill("#name", name)
        self.tab.fill("#pin", PIN)
        self.tab.press("#pin", "Enter")
        expect(self.tab.locator("#who")).to_contain_text(name)

    def button(self, name: str) -> Any:
        return self.tab.locator(f"#cmd-{name}")

    def press(self, target: Any, seconds: float) -> None:
        target.hover()
        self.tab.mouse.down()
        self.tab.wait_for_timeout(1000 * seconds)
        self.tab.mouse.up()
