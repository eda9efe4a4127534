"""What a fault may lead to, and what it may not."""

from dataclasses import replace
from typing import Any

import pytest

from benchmarks.faults.judgement import judge
from benchmarks.faults.observation import Effect, Moved, Observation
from tests.unit.benchmarks.faults.seen import BRAKED, CALM, EXPECTED

UP = Moved("main", begun_s=1.2, ended_s=4.0, travel_mm=2.0, rise_mm=2.0, turn_deg=0.0)
LATER = Moved("aux_1", begun_s=2.5, ended_s=3.0, travel_mm=1.0, rise_mm=0.0, turn_deg=0.0)


def with_effect(effect: Effect, **changes: Any) -> Observation:
    return replace(CALM, expected=replace(EXPECTED, effect=effect), **changes)


def test_figures_of_a_stop() -> None:
    judgement = judge(replace(CALM, motions=[BRAKED, replace(BRAKED, begun_s=0.5, ended_s=0.9)]))
    assert judgement.passed
    assert judgement.standstill_s == 0.9
    assert judgement.travel_mm == 24.0
    assert judgement.turn_deg == 1.0
    assert judgement.backed_off_mm == 0.0


def test_an_arm_that_stood_is_as_demanded() -> None:
    judgement = judge(replace(CALM, motions=[]))
    assert judgement.passed
    assert (judgement.standstill_s, judgement.travel_mm) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("changes", "wrong"),
    [
        ({"motions": [replace(BRAKED, ended_s=2.1)]}, "stood after 2.10 s, bound 2.00 s"),
        ({"motions": [replace(BRAKED, ended_s=None)]}, "still moved"),
        ({"motions": [BRAKED, replace(LATER, ended_s=1.9, begun_s=1.4)]}, "moved again"),
        ({"peak_n": 50.1}, "peak 50.1 N, bound 50 N"),
        ({"state": "Completed", "record": "bad"}, "moved on to Completed"),
        ({"state": "Execute", "ended_s": None}, "moved on to Execute"),
        ({"state": "Idle"}, "moved on to Idle"),
        ({"record": "good"}, "record says good"),
        ({"record": "open"}, "left open"),
        ({"record": None}, "no record"),
        ({"shown": []}, "no alarm"),
        ({"restarted": True}, "new daemon"),
        ({"idle_again": False}, "back to Idle"),
    ],
)
def test_what_must_not_be(changes: dict[str, Any], wrong: str) -> None:
    judgement = judge(replace(CALM, **changes))
    assert not judgement.passed
    assert any(wrong in text for text in judgement.wrong)


def test_back_off_is_allowed_after_its_faults_alone() -> None:
    seen = replace(CALM, motions=[BRAKED, UP], ended_s=4.1)
    after = judge(replace(seen, shown=[512]))
    assert after.passed
    assert (after.standstill_s, after.backed_off_mm) == (0.4, 2.0)
    assert not judge(seen).passed


@pytest.mark.parametrize(("travel_mm", "rise_mm"), [(2.5, 2.5), (2.0, -2.0)])
def test_a_back_off_is_short_and_up(travel_mm: float, rise_mm: float) -> None:
    motions = [BRAKED, replace(UP, travel_mm=travel_mm, rise_mm=rise_mm)]
    assert not judge(replace(CALM, motions=motions, shown=[512], ended_s=4.1)).passed


def test_a_move_may_end_but_none_begin() -> None:
    long = replace(BRAKED, ended_s=1.8)
    assert judge(with_effect(Effect.MOVE_ENDS, motions=[long], state="Held")).passed
    seen = judge(with_effect(Effect.MOVE_ENDS, motions=[BRAKED, replace(UP, ended_s=1.9)]))
    assert "a move began when the fault was known" in seen.wrong
    known_later = replace(EXPECTED, effect=Effect.MOVE_ENDS, noticed_s=1.5)
    motions = [BRAKED, replace(UP, ended_s=1.9)]
    assert judge(replace(CALM, expected=known_later, motions=motions, ended_s=2.0)).passed


def test_what_is_not_used_may_go_on_until_the_job_ends() -> None:
    motions = [BRAKED, replace(LATER, ended_s=20.0)]
    assert judge(with_effect(Effect.AT_NEXT_USE, motions=motions, ended_s=21.0)).passed
    assert not judge(with_effect(Effect.AT_NEXT_USE, motions=motions, ended_s=2.0)).passed
    good = {"state": "Completed", "record": "good"}
    assert len(judge(with_effect(Effect.AT_NEXT_USE, **good)).wrong) == 2


def test_a_start_that_is_refused_leaves_the_cell_in_idle() -> None:
    seen = replace(CALM, motions=[], state="Idle", refused=0x107, record=None, shown=[])
    assert judge(seen).passed
    assert not judge(replace(seen, refused=0)).passed
    of_calibrations = replace(seen, refused=0x106)
    assert not judge(of_calibrations).passed, "refused, but not for the fault"
    assert judge(replace(of_calibrations, fault="clock-back")).passed


def test_of_a_dead_daemon_the_line_sees_nothing() -> None:
    expected = replace(EXPECTED, line_silent=True)
    seen = replace(CALM, expected=expected, state="silent", shown=[821], ended_s=None)
    assert judge(replace(seen, record="interrupted")).passed
    assert not judge(replace(seen, record="good")).passed


def test_jobs_without_a_record_need_none() -> None:
    assert judge(replace(CALM, expected=replace(EXPECTED, has_record=False), record=None)).passed
