"""Curves whose forces lie about the way, whatever their pushes and their columns."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from cellctl.processes.peg_in_hole.faults import PegCurveInvalid
from cellctl.processes.peg_in_hole.offline.curve import parse_curve
from cellctl.processes.peg_in_hole.offline.evidence import evidence_of
from cellctl.processes.peg_in_hole.offline.judge import judge_curve
from cellctl.processes.peg_in_hole.offline.task_file import TaskOfCurve, parse_part
from cellctl.processes.peg_in_hole.verdict.judgement import PegVerdict
from tests.rigs.insertion.curves import NAMES, TASK, Inserted, as_csv, inserted
from tests.rigs.sweeps import sweep

PART = parse_part(TASK)
PUSHED = Inserted(comes_back=True)
_FZ = NAMES.index("fz_n")


SIDES = (("fx_n",), ("fy_n",), ("fx_n", "fy_n"))
QUICK = (
    (True, 6.5, 0.1, SIDES[0]),
    (False, 20.0, 2.0, SIDES[1]),
    (True, 10.0, 0.1, SIDES[2]),
)  # fmt: skip


@pytest.mark.parametrize(
    ("named", "push_n", "play_mm", "turned"),
    sweep(product((True, False), (6.5, 10.0, 20.0), (0.1, 2.0), SIDES), QUICK),
)
def test_a_side_force_of_the_other_sign_is_refused_however_hard_the_push(
    named: bool, push_n: float, play_mm: float, turned: tuple[str, ...]
) -> None:
    for comes_back in (True, False):
        made = replace(PUSHED, push_n=push_n, play_mm=play_mm, comes_back=comes_back)
        rows, kinds = inserted(made)
        rows[:, [NAMES.index(name) for name in turned]] *= -1.0
        curve = parse_curve(as_csv(rows, kinds if named else None))
        with pytest.raises(
            PegCurveInvalid, match=f"{turned[0][:2]} acts with the way of the pushes"
        ):
            judge_curve(curve, PART)


@pytest.mark.parametrize("push_n", [6.5, 10.0, 15.0, 20.0])
def test_the_play_does_not_grow_with_the_push(push_n: float) -> None:
    rows, _ = inserted(replace(PUSHED, push_n=push_n))
    evidence, judgement = judge_curve(parse_curve(as_csv(rows)), PART)
    assert evidence.capture is not None
    assert evidence.capture.play_x_m == pytest.approx(0.1e-3, abs=0.03e-3)
    assert judgement.verdict is PegVerdict.INSERTED, [str(check) for check in judgement.checks]


@pytest.mark.parametrize("named", [True, False])
def test_a_zero_that_contacts_hide_at_the_seat_is_seen_on_the_way_to_them(named: bool) -> None:
    """From 5 mm on contacts hold the part back with more than what the zero is off by."""
    rows, kinds = inserted(PUSHED)
    rubs = rows[:, NAMES.index("depth_mm")] > 5.0
    rows[rubs, _FZ] -= 20.0
    rows[:, _FZ] += 5.0
    curve = parse_curve(as_csv(rows, kinds if named else None))
    assert evidence_of(curve, TaskOfCurve.of(PART)).with_feed_n == pytest.approx(4.9, abs=0.3)


def test_a_peg_that_its_walls_hold_as_it_is_drawn_back_shows_no_force_with_the_feed() -> None:
    rows, _ = inserted(PUSHED)
    back = rows[(rows[:, NAMES.index("depth_mm")] > 5.0) & (rows[:, 0] < 8.0)][::-1].copy()
    back[:, _FZ] = 6.0
    again = rows[rows[:, 0] > 8.0]
    first = rows[rows[:, 0] <= 8.0]
    whole = np.concatenate([first, back, again])
    whole[:, 0] = 0.01 * np.arange(len(whole))
    evidence = evidence_of(parse_curve(as_csv(whole)), TaskOfCurve.of(PART))
    assert evidence.with_feed_n is not None
    assert evidence.with_feed_n < 1.0


def test_a_feed_in_which_the_sensor_was_asked_counts_from_its_beginning() -> None:
    """What held the part back before the question tells of slip."""
    rows, kinds = inserted(PUSHED)
    depths_mm = rows[:, NAMES.index("depth_mm")]
    held = (depths_mm > 5.0) & (depths_mm < 9.0)
    rows[held, _FZ] -= 6.0
    asked = int(np.argmax(depths_mm > 11.5))
    question = np.repeat(rows[asked : asked + 1], 10, axis=0)
    question[:, NAMES.index("x_mm")] += np.linspace(0.0, 0.05, 10)
    whole = np.concatenate([rows[:asked], question, rows[asked:]])
    whole[:, 0] = 0.01 * np.arange(len(whole))
    first = kinds[:asked]
    named = [*first, *[(first[-1][0] + 1, "touch")] * 10]
    named += [(motion + 2, kind) for motion, kind in kinds[asked:]]
    evidence = evidence_of(parse_curve(as_csv(whole, named)), TaskOfCurve.of(PART))
    assert evidence.held_way_m is not None
    assert evidence.held_way_m * 1e3 == pytest.approx(4.0, abs=0.2)
