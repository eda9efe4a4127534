"""One Chromium for all tests of the page; without one they are skipped."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

from tests.unit.hmi.page.screen import Screen, Tabs
from tests.unit.hmi.scripted_daemon import PaperDaemon, page_thread, serving

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")


@pytest.fixture(scope="package")
def tabs() -> Iterator[Tabs]:
    if CHROMIUM is None:
        pytest.skip("no Chromium on this machine")
    arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield Tabs(browser)
        browser.close()


@pytest.fixture
def address(settings: Path, paper: PaperDaemon) -> Iterator[str]:
    """Of the page before the daemon made of paper."""
    with serving(settings.parent / "s", paper), page_thread(settings) as url:
        yield url


@pytest.fixture
def screen(tabs: Tabs, address: str) -> Iterator[Screen]:
    with Screen(tabs, address) as found:
        yield found
