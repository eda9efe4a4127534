"""Somebody with a browser before the page of a cell: signs in, commands, waits, takes pictures."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from uuid import uuid4

from playwright.sync_api import sync_playwright

_SENT = """async ([command, key]) => {
    const status = await (await fetch("/api/v1/status")).json();
    const headers = { "Content-Type": "application/json", "Idempotency-Key": key };
    const body = JSON.stringify({ command, decision: status.decision });
    const reply = await fetch("/api/v1/commands", { method: "POST", headers, body });
    return [reply.status, await reply.text()];
}"""
_STATUS = "async () => (await fetch('/api/v1/status')).json()"


class Person:
    """One tab, whose person may do everything."""

    def __init__(self, tab: Any, url: str, pin: str) -> None:
        self.tab = tab
        self.url = url
        tab.goto(url)
        tab.click("#who")
        tab.fill("#name", "engineer")
        tab.fill("#pin", pin)
        tab.press("#pin", "Enter")
        tab.wait_for_selector("dialog", state="detached")

    def status(self) -> dict[str, Any]:
        """The newest snapshot; empty while the cell says nothing."""
        found: dict[str, Any] = self.tab.evaluate(_STATUS)
        return found if "state" in found else {}

    def until(
        self, what: str, seen: Any, timeout_s: float = 1500.0, *, faults: bool = False
    ) -> dict[str, Any]:
        """The snapshot in which ``seen`` is true for the first time.

        Raises ``TimeoutError``, and ``RuntimeError`` for a fault that comes instead, unless
        ``faults`` may come.
        """
        status: dict[str, Any] = {}
        before = len(self.status().get("faults", ()))
        for _ in range(int(timeout_s / 0.25)):
            status = self.status()
            if status and seen(status):
                return status
            if not faults and len(status.get("faults", ())) > before:
                raise RuntimeError(f"no {what}: {[one['text'] for one in status['faults']]}")
            self.tab.wait_for_timeout(250)
        raise TimeoutError(f"no {what}: {status}")

    def command(self, request: str, state: str = "", **more: Any) -> None:
        """Give a command and wait for the state that it leads to; raises ``RuntimeError``."""
        status, text = self.tab.evaluate(_SENT, [{"request": request, **more}, uuid4().hex])
        if status != 202:
            raise RuntimeError(f"{request}: {status} {text}")
        if state:
            self.until(state, lambda one: one["state"] == state)

    def to_idle(self) -> None:
        """From wherever the cell rests."""
        self.until("cell", lambda one: one["connected"])
        for state, request, then in (
            ("ABORTED", "clear", "STOPPED"),
            ("STOPPED", "reset", "IDLE"),
            ("COMPLETED", "reset", "IDLE"),
        ):
            if self.status()["state"] == state:
                self.command(request, then)

    def show(self, screen: str, file: Path) -> None:
        """A picture of what the window shows of a screen."""
        self.tab.goto(f"{self.url}#{screen}")
        self.tab.wait_for_timeout(700)
        self.tab.screenshot(path=file)


@contextmanager
def chromium() -> Iterator[Any]:
    """The browser of this computer; raises ``FileNotFoundError`` without one."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        raise FileNotFoundError("no Chromium on this computer: apt-get install chromium")
    arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=path, args=arguments)
        yield browser
        browser.close()
