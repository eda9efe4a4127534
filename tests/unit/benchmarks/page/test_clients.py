"""The table of what the page costs."""

import math

from rich.console import Console

from benchmarks.page.clients import Page, Turn, table

NOBODY = (math.nan, math.nan)
MIB = {Page.QUIET: 80.0, Page.READ: 92.0, Page.FROZEN: 80.0, Page.KILLED: math.nan}


def turn(page: Page) -> Turn:
    return Turn(
        page,
        readers=50 if page is Page.READ else 0,
        guard_ms=(0.2, 0.4, 0.6, 1.0),
        stalled=0.0,
        part_s=(),
        page_cpu=0.03,
        page_mib=MIB[page],
        late_ms=(17.0, 63.0) if page is Page.READ else NOBODY,
        tick_late_ms=(1.0, 9.0),
        verdict_ms=NOBODY,
        load_average=1.0,
    )


def test_the_memory_of_the_page_stands_beside_its_share_of_a_core() -> None:
    console = Console(width=120)
    with console.capture() as shown:
        console.print(table([turn(page) for page in Page]))
    (line,) = (line for line in shown.get().splitlines() if "page, resident" in line)
    told = [cell.strip() for cell in line.strip("│").split("│")]
    assert told == ["page, resident", "80 MiB (1.00)", "92 MiB (1.15)", "80 MiB (1.00)", "—"]
