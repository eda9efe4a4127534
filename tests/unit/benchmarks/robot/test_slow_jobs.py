"""The sweep of slow interpreters: each cause stops a motion, and the figures are exact."""

import math
import random

import pytest

from benchmarks.robot.quick_time import QuickTime
from benchmarks.robot.slow_jobs import Row, main, measure, table
from benchmarks.robot.slow_trials import ALIVE, STOPPING, Trial, trial

ROUND_MS = 110.0
"""Round of a background job at 1 ms a statement, with a margin."""
DEADMAN_MS = 300.0


def tried(cause: str, statement_ms: float = 1.0) -> Trial:
    return QuickTime().run(trial(statement_ms / 1000, cause, random.Random(3)))


@pytest.mark.parametrize("cause", STOPPING)
def test_every_cause_stops_a_motion(cause: str) -> None:
    one = tried(cause)
    assert one.stop_ms is not None
    allowed_ms = 2 * ROUND_MS + (DEADMAN_MS if "silent" in cause else 0.0)
    assert one.stop_ms < allowed_ms
    assert 50.0 < one.report_ms < ROUND_MS
    if cause == "contact":
        assert one.stop_ms < 5.0
    if "silent" in cause:
        assert one.stop_ms > DEADMAN_MS - ROUND_MS


def test_a_pc_that_is_there_keeps_a_quick_job_moving() -> None:
    assert tried("undisturbed").stop_ms is None


def test_one_late_answer_stops_a_slow_job() -> None:
    """Two of its rounds are longer than its dead man's time."""
    assert tried("one late answer", 5.0).stop_ms is not None
    assert tried("undisturbed", 5.0).stop_ms is None


@pytest.mark.long
def test_the_same_seed_is_the_same_row() -> None:
    rows = [QuickTime().run(measure(2.0, 1, seed=4)) for _ in range(2)]
    assert rows[0].stop_ms["STA stop"][0] == pytest.approx(rows[1].stop_ms["STA stop"][0], abs=2.0)


def test_a_motion_that_is_not_stopped_is_not_hidden() -> None:
    three = (10.0, 11.0, math.inf)
    stops = dict.fromkeys(STOPPING, three)
    row = Row(1.0, 50, three, three, stops, dict.fromkeys(ALIVE, 2))
    assert "10 / 11 / inf" in table([row])
    assert "2 of 50" in table([row])


def test_the_command_prints_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--ms", "2", "--trials", "1"]) == 0
    assert "| 2 |" in capsys.readouterr().out
