"""The board tells everybody of every change."""

import math

from cellctl.runtime.progress import Progress, ProgressBoard
from cellctl.runtime.step import Step


def test_changes_reach_the_observers_and_reset_clears() -> None:
    board, seen = ProgressBoard(), []
    board.observers.append(seen.append)
    board.update(step=Step.COMPENSATE, iteration=2)
    board.update(force_limit_n=50.0)
    assert board.current.iteration == 2
    assert board.current.step is Step.COMPENSATE
    board.reset()
    assert [progress.iteration for progress in seen] == [2, 2, 0]
    assert board.current.step is Step.NONE
    assert all(math.isnan(value) for value in board.current.error_mm_deg)
    assert math.isnan(board.current.force_limit_n)
    assert Progress().message == ""


def test_steps_have_words() -> None:
    assert Step.MEASURE_FRAME.label == "measure frame"
    assert [step for step in Step if 0 < step < 100] == sorted(
        step for step in Step if 0 < step < 100
    )
