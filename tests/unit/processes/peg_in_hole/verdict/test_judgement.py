from dataclasses import fields, replace

import pytest

from cellctl.processes.peg_in_hole.faults import (
    ForceActsWithFeed,
    ForceDropped,
    NotSeated,
    PegNotHeld,
    PegSlipped,
    SensorDead,
)
from cellctl.processes.peg_in_hole.plan.task import PartContacts
from cellctl.processes.peg_in_hole.verdict.evidence import InsertionEvidence, LateralCapture
from cellctl.processes.peg_in_hole.verdict.judgement import (
    RETOUCH,
    SLIP,
    SLOPE,
    PegSeatLimits,
    judge_peg,
)
from cellctl.processes.peg_in_hole.verdict.lateral import push_force_n
from tests.unit.processes.peg_in_hole.tasks import pin

SEAT = PegSeatLimits(5.0, 30.0, keyed=True, pull_n=5.0)
GOOD = InsertionEvidence(
    depth_m=12.1e-3,
    seat_force_n=10.0,
    seat_slope_n_m=0.8e6,
    held_way_m=0.02e-3,
    unrubbed_way_m=0.0,
    with_feed_n=0.5,
    dropped_n=0.9,
    capture=LateralCapture(4, 0.04e-3, 0.05e-3, 0.01e-3, 30.0),
    greatest_force_n=12.0,
    grip_force_n=40.0,
    retouch_error_m=None,
    keyed_directions=2,
    held_pull_n=6.0,
)


def test_all_items_make_an_inserted_peg() -> None:
    judgement = judge_peg(GOOD, pin(), SEAT)
    assert judgement.inserted
    assert judgement.to_record()["fault"] is None
    assert len(judgement.checks) == 15


@pytest.mark.parametrize(
    "name",
    [field.name for field in fields(InsertionEvidence) if field.name != "retouch_error_m"],
)
def test_what_is_unknown_is_not_inserted(name: str) -> None:
    task = pin()
    task = replace(task, fit=replace(task.fit, contacts=PartContacts(6e-3, 7e-3, 2.0, 5.0)))
    judgement = judge_peg(replace(GOOD, **{name: None}), task, SEAT)
    assert not judgement.inserted
    assert judgement.fault is not None


def test_a_great_force_asks_for_the_touch_on_the_rear() -> None:
    pushed = replace(GOOD, greatest_force_n=30.0)
    judgement = judge_peg(pushed, pin(), SEAT)
    assert isinstance(judgement.fault, PegSlipped)
    touched = judge_peg(replace(pushed, retouch_error_m=0.1e-3), pin(), SEAT)
    assert touched.inserted
    assert RETOUCH in {check.name for check in touched.checks}
    assert SLIP in {check.name for check in judge_peg(GOOD, pin(), SEAT).checks}


def test_a_part_that_was_held_back_on_its_way_has_slipped() -> None:
    # Far below the grip force that is stated: the fingers rub with less than they were measured.
    judgement = judge_peg(replace(GOOD, held_way_m=0.3e-3), pin(), SEAT)
    assert isinstance(judgement.fault, PegSlipped)


def test_a_part_whose_contacts_were_not_felt_has_slipped() -> None:
    task = pin()
    task = replace(task, fit=replace(task.fit, contacts=PartContacts(6e-3, 7e-3, 2.0, 5.0)))
    assert judge_peg(GOOD, task, SEAT).inserted
    judgement = judge_peg(replace(GOOD, unrubbed_way_m=0.3e-3), task, SEAT)
    assert isinstance(judgement.fault, PegSlipped)


def test_a_force_with_the_feed_is_none_that_a_hole_makes() -> None:
    judgement = judge_peg(replace(GOOD, with_feed_n=12.0), pin(), SEAT)
    assert isinstance(judgement.fault, ForceActsWithFeed)


def test_a_force_that_drops_in_the_feed_is_not_to_be_believed() -> None:
    judgement = judge_peg(replace(GOOD, dropped_n=6.0), pin(), SEAT)
    assert isinstance(judgement.fault, ForceDropped)


def test_a_part_that_nobody_has_pushed_is_named_by_where_it_stands() -> None:
    short = replace(GOOD, depth_m=6e-3, capture=None)
    assert isinstance(judge_peg(short, pin(), SEAT).fault, NotSeated)
    assert isinstance(judge_peg(replace(GOOD, capture=None), pin(), SEAT).fault, SensorDead)
    dead = replace(short, capture=LateralCapture(4, 0.04e-3, 0.05e-3, 0.01e-3, 1.0))
    assert isinstance(judge_peg(dead, pin(), SEAT).fault, SensorDead)


def test_the_rise_at_the_seat_is_told_as_pages_tell_it() -> None:
    (rise,) = (one for one in judge_peg(GOOD, pin(), SEAT).checks if one.name == SLOPE)
    assert str(rise).startswith("rise of the force at the seat 800 N/mm")


def test_a_part_without_keys_needs_no_turn() -> None:
    bare = replace(GOOD, keyed_directions=None, held_pull_n=None)
    assert judge_peg(bare, pin(), PegSeatLimits(5.0, 30.0)).inserted
    assert isinstance(judge_peg(bare, pin(), SEAT).fault, PegNotHeld)


def test_the_push_is_stronger_than_friction_on_a_chamfer() -> None:
    # 45 degrees: a press of 2 N is resisted by 2 N (1 + μ) / (1 - μ) at most.
    assert push_force_n(pin(friction=0.35).cell) > 2 * 2 * 1.35 / 0.65
    assert push_force_n(pin(friction=0.0).cell) > 4
