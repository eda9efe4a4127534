"""What a page costs the event loop of the daemon."""

import time
from collections.abc import Callable

import pytest

from cellctl.api.local_socket.live_feed import as_line
from tests.unit.api.local_socket.test_page import Page
from tests.unit.daemon_rig import DaemonRig

MOST_MS = 0.3
"""Of a snapshot, ten of them a second: 0.3 % of a processor, and no robot waits for it."""
SLOW_MOST_MS = 3.0
"""Of what is asked twice a second besides."""


def processor_ms(act: Callable[[], object], times: int) -> float:
    """The best of ten batches: in the others something else ran in between."""
    batches = []
    for _ in range(10):
        begun_s = time.process_time()
        for _ in range(times):
            act()
        batches.append((time.process_time() - begun_s) / times * 1e3)
    return min(batches)


@pytest.fixture
def page(rig: DaemonRig) -> Page:
    return Page(rig)


async def test_a_snapshot_costs_the_loop_little(rig: DaemonRig, page: Page) -> None:
    await rig.idle()
    status = rig.shown()
    quick_ms = processor_ms(lambda: as_line(page.view.snapshot(status)), 50)
    slow_ms = processor_ms(page.view._slowly, 5)
    assert quick_ms < MOST_MS
    assert slow_ms < SLOW_MOST_MS
