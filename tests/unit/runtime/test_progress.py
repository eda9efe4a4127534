"""The board of progress tells of every change."""

import math

from cellctl.runtime.progress import Progress, ProgressBoard, on_new_message


def test_observers_are_told_of_every_change() -> None:
    board, told = ProgressBoard(), list[Progress]()
    board.observers.append(told.append)
    board.update(step=40, step_label="correct pose", iteration=2)
    board.update(message="measuring")
    assert board.current.step == 40
    assert (board.current.iteration, board.current.message) == (2, "measuring")
    board.leave_step()
    assert (board.current.step, board.current.step_label, board.current.iteration) == (0, "", 0)
    assert board.current.message, "what was told last stays to be seen"
    board.reset()
    assert board.current.message == ""
    assert len(told) == 4


def test_nothing_is_known_at_first() -> None:
    progress = Progress()
    assert all(math.isnan(value) for value in (*progress.error_mm_deg, *progress.force_peaks))
    assert not progress.contact


def test_a_message_is_told_once() -> None:
    board, told = ProgressBoard(), list[str]()
    board.observers.append(on_new_message(told.append))
    board.update(message="search")
    board.update(iteration=1)
    board.update(message="insert")
    board.reset()
    board.update(message="insert")
    assert told == ["search", "insert", "insert"]
