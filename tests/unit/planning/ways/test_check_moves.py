from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.errors.config import (
    BodiesCollide,
    ClearanceTooSmall,
    ConfigInvalid,
    PlaceUnreachable,
)
from cellctl.planning.scene.solid import Solid
from cellctl.planning.ways import check_moves
from cellctl.planning.ways.check_moves import check_move, stated_moves
from cellctl.planning.ways.plan_ways import with_ways
from tests.unit.planning.deck_cell import deck_scene

SCENE = deck_scene()
MOVES = list(stated_moves(SCENE))


def stated(robot: str, start: str, end: str) -> StatedMove:
    (move,) = [
        move
        for move in MOVES
        if (move.robot, move.start.label, move.end.label) == (robot, start, end)
    ]
    return move


def test_each_arm_has_moves_and_each_procedure_brings_its_own() -> None:
    assert {move.robot for move in MOVES} == {"main", "aux_1", "aux_2"}
    labels = {move.end.label for move in MOVES}
    assert {"seat", "stand-off", "view 24", "tilt 17", "above home", "end of A2's arc"} <= labels


def test_heads_move_freely_past_the_main_arm_at_home() -> None:
    checked = check_move(SCENE, stated("aux_2", "retracted", "measuring"))
    assert checked.fault is None
    assert checked.narrowest is not None
    assert {checked.narrowest.gap.first, checked.narrowest.gap.second} == {
        "aux_2.forearm",
        "main.deck at home",
    }


def test_a_deck_that_would_go_straight_through_the_heads_is_found() -> None:
    straight = with_ways(SCENE, [])
    checked = check_move(straight, stated("main", "home", "deck_measure"))
    assert isinstance(checked.fault, ClearanceTooSmall)
    text = str(checked.fault)
    for part in (
        "main: home to deck_measure",
        "main.deck",
        "aux_2.forearm at measuring",
        "mm apart",
    ):
        assert part in text


def test_the_deck_may_touch_the_frame_in_an_approach_only() -> None:
    move = stated("main", "stand-off", "seat")
    assert check_move(SCENE, move).fault is None
    assert check_move(SCENE, replace(move, approach=False)).fault is not None


def test_a_margin_larger_than_the_gap_is_told_from_a_collision() -> None:
    wide = [
        replace(solid, margin_m=0.06) if solid.arm == "main" else solid for solid in SCENE.solids
    ]
    move = stated("main", "deck_measure", "above the stand-off")
    checked = check_move(replace(SCENE, solids=tuple(wide)), move)
    assert isinstance(checked.fault, ClearanceTooSmall)
    assert "60.0 mm required" in str(checked.fault)


def test_what_stands_in_the_way_is_named() -> None:
    (frame,) = [solid for solid in SCENE.solids if solid.name == "frame"]
    arm = SCENE.arms["aux_1"]
    flange = arm.cell_T_base * arm.base_T_flange(arm.taught_rad("retracted"))
    post = Solid("post", None, 0, flange.as_matrix(), frame.shape, margin_m=0.0, stand_in=False)
    crowded = replace(SCENE, solids=(*SCENE.solids, post))
    checked = check_move(crowded, stated("aux_1", "measuring", "retracted"))
    assert isinstance(checked.fault, ClearanceTooSmall | BodiesCollide)
    assert "post" in str(checked.fault)


@pytest.mark.parametrize("place_m", [(9.0, 0.0, 1.0), (1.9, 0.0, 0.2)])
def test_a_place_out_of_reach_is_refused(place_m: tuple[float, float, float]) -> None:
    start = stated("main", "deck_measure", "home").start
    pose = RigidTransform.from_components(
        place_m, SCENE.arms["main"].base_T_flange(start.joints_rad).rotation
    )
    end = StatedPlace("away", start.joints_rad, pose)
    checked = check_move(SCENE, StatedMove("main", MoveKind.LINEAR, start, end))
    assert isinstance(checked.fault, PlaceUnreachable)


def test_a_zone_in_which_a_head_stands_is_closed() -> None:
    move = stated("main", "deck_measure", "home")
    aside = StatedPlace("aside", np.radians([-20.3, -71.4, 114.8, -27.7, 80.7, 90.0]))
    heads = stated("main", "home", "deck_measure").others
    checked = check_move(SCENE, replace(move, end=aside, others=heads))
    assert isinstance(checked.fault, PlaceUnreachable)
    assert "beside_head_1" in str(checked.fault)


def test_joints_beyond_their_limits_are_refused() -> None:
    start = stated("main", "deck_measure", "home").start
    end = StatedPlace("beyond", np.radians([95.0, -90.0, 90.0, 0.0, 90.0, 90.0]))
    checked = check_move(SCENE, StatedMove("main", MoveKind.JOINT, start, end))
    assert isinstance(checked.fault, PlaceUnreachable)
    assert "95.0" in str(checked.fault)


def test_a_move_that_other_arms_stand_beside_elsewhere_is_stated_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    move = stated("main", "home", "deck_measure")
    elsewhere = {
        name: tuple(replace(place, joints_rad=place.joints_rad + 0.1) for place in places)
        for name, places in move.others.items()
    }
    told = [move, replace(move, others=elsewhere), move]
    recipe = SCENE.cell.recipes[0]
    cell = SCENE.cell.model_copy(update={"recipes": (recipe,)})

    class Definition:
        @staticmethod
        def moves(_cell: object, _recipe: object, _folder: object) -> list[StatedMove]:
            return told

    monkeypatch.setattr(check_moves, "process_definition", lambda _name: Definition)
    assert [dict(one.others) for one in stated_moves(replace(SCENE, cell=cell))] == [
        dict(move.others),
        elsewhere,
    ]


@pytest.mark.parametrize(
    ("procedures", "there"), [({103, 109}, False), ({103, 108}, True), (set(), True)]
)
def test_a_body_is_away_in_moves_that_its_procedures_alone_make(
    procedures: set[int], there: bool
) -> None:
    names = {solid.name for solid in SCENE.during(frozenset(procedures)).solids}
    assert ("main.deck" in names) is there


def test_a_procedure_that_moves_nothing_is_refused() -> None:
    solids = tuple(replace(one, absent_in=frozenset({103, 999})) for one in SCENE.solids)
    with pytest.raises(ConfigInvalid, match=r"names \[999\].*no run makes: \[101, 102, 103"):
        next(check_moves.check_moves(replace(SCENE, solids=solids)))
