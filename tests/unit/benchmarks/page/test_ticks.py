"""The follower of the benchmark before a daemon made of paper, which ticks every 50 ms."""

import time
from pathlib import Path

from benchmarks.page.ticks import PERIOD_S, followed
from tests.rigs.waiting import until_blocking
from tests.unit.hmi.scripted_daemon import PaperDaemon, serving

SILENT_S = 1.0


def test_ticks_that_stay_away_are_late(tmp_path: Path) -> None:
    paper = PaperDaemon()
    with serving(tmp_path / "s", paper), followed(tmp_path / "s") as ticks:
        until_blocking(lambda: len(ticks.late_s) > 3)
        paper.silent = True
        time.sleep(SILENT_S)
        paper.silent = False
        heard = len(ticks.late_s)
        until_blocking(lambda: len(ticks.late_s) > heard + 1)
    assert max(ticks.late_s) > SILENT_S - PERIOD_S - 0.1
    assert min(ticks.late_s) < PERIOD_S
    assert all(0.0 <= one < 5.0 for one in ticks.under_way_s)
    assert ticks.ended == ""


def test_a_daemon_that_hangs_up_is_told(tmp_path: Path) -> None:
    with serving(tmp_path / "s", PaperDaemon()):
        following = followed(tmp_path / "s")
        ticks = following.__enter__()
        until_blocking(lambda: len(ticks.late_s) > 0)
    until_blocking(lambda: bool(ticks.ended))
    following.__exit__(None, None, None)
