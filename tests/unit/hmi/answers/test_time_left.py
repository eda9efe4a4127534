"""What is left of a run, by what its steps have taken in good runs."""

from datetime import UTC, datetime, timedelta

from cellctl.hmi.answers.time_left import NOTHING, time_left, usual_steps
from cellctl.records.entries import Phase

BEGIN = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC)
STEPS = ((10, 20.0), (20, 5.0), (50, 30.0))


def phases(*steps: tuple[int, float | None]) -> list[Phase]:
    """Steps one after the other with how long each has taken; None for one that lasts."""
    found, began = [], BEGIN
    for identity, (number, seconds) in enumerate(steps):
        ended = None if seconds is None else began + timedelta(seconds=seconds)
        found.append(Phase(identity, number, f"step {number}", began, ended))
        began = ended or began
    return found


def test_what_is_left_is_the_rest_of_this_step_and_those_after_it() -> None:
    usual = usual_steps([phases(*STEPS)])
    told = time_left(phases((10, 19.0), (20, None)), usual, 1, BEGIN + timedelta(seconds=21.0))
    assert (told.number, told.step, told.of, told.by_runs) == (20, 2, 3, 1)
    assert told.left_s == 3.0 + 30.0
    assert not told.longer


def test_a_step_that_takes_longer_leaves_those_after_it_and_never_less_than_nothing() -> None:
    usual = usual_steps([phases(*STEPS)])
    late = BEGIN + timedelta(seconds=900.0)
    told = time_left(phases((10, 19.0), (20, None)), usual, 1, late)
    assert (told.longer, told.left_s) == (True, 30.0)
    last = time_left(phases((10, 19.0), (50, None)), usual, 1, late)
    assert (last.longer, last.left_s) == (True, 0.0)


def test_a_run_that_was_held_does_not_lengthen_what_is_usual() -> None:
    held = phases((10, 20.0), (20, 3600.0), (50, 31.0))
    usual = usual_steps([phases(*STEPS), held, phases(*STEPS)])
    assert [(one.number, one.seconds) for one in usual] == list(STEPS)


def test_steps_that_began_anew_count_by_their_last_time() -> None:
    anew = phases((10, 20.0), (20, 700.0), (10, 22.0), (20, 6.0), (50, 30.0))
    assert [one.seconds for one in usual_steps([anew])] == [22.0, 6.0, 30.0]


def test_without_a_good_run_or_an_open_step_nothing_is_claimed() -> None:
    now = BEGIN + timedelta(seconds=1.0)
    assert time_left(phases((10, None)), usual_steps([]), 0, now) == NOTHING
    usual = usual_steps([phases(*STEPS)])
    assert time_left([], usual, 1, now) == NOTHING
    assert time_left(phases((10, 20.0)), usual, 1, now) == NOTHING
    assert time_left(phases((99, None)), usual, 1, now) == NOTHING
