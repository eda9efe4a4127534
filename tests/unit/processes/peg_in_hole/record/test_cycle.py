"""What is written of a search that has not touched, and of a ratio of forces."""

import asyncio
from dataclasses import replace
from typing import Any, cast

import numpy as np

from cellctl.calibration.checks import LimitCheck
from cellctl.processes.peg_in_hole.cycle import CycleLog
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.record.cycle import _figure, record_search
from cellctl.processes.peg_in_hole.search.hole_map import HoleMap
from cellctl.processes.peg_in_hole.verdict.judgement import PLAY_X, SLIP
from cellctl.records.entries import Figure
from cellctl.records.run_recorder import RunRecorder
from tests.unit.processes.peg_in_hole.verdict.test_judgement import GOOD


class Kept:
    """Takes figures as a recorder does."""

    def __init__(self) -> None:
        self.found: dict[str, Figure] = {}

    async def document(self, key: str, content: Any) -> None: ...

    async def figures(self, entries: list[Figure]) -> None:
        self.found |= {entry.key: entry for entry in entries}


def test_a_search_that_has_touched_nothing_has_no_time() -> None:
    kept = Kept()
    log = CycleLog(HoleMap(1e-3, 0.5e-3))
    assert np.isfinite(log.hole_map.weights).all()
    asyncio.run(record_search(cast(RunRecorder, kept), log))
    assert kept.found[keys.SEARCH_TIME].value is None
    assert kept.found[keys.TOUCHES].value == 0


def test_the_forces_of_which_a_ratio_is_judged_stand_beside_it() -> None:
    evidence = replace(GOOD, greatest_force_n=20.0, grip_force_n=60.0)
    ratio = _figure(LimitCheck(SLIP, 20 / 60, 0.6, ""), evidence)
    assert ratio.label == "verdict: greatest force over grip force, 20 N of 60 N"
    play = _figure(LimitCheck(PLAY_X, 0.05, 0.2, "mm"), evidence)
    assert play.label == "verdict: play along x"
