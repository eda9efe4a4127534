"""Boxes of the shipped zones, larger ones and smaller ones, against what could meet beside them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.planning.model.shapes import CapsuleShape
from cellctl.planning.scene.cell_scene import CellScene, Standpoint
from cellctl.planning.scene.solid import Solid
from cellctl.planning.ways import check_zones
from cellctl.planning.ways.check_moves import stated_moves
from cellctl.planning.ways.check_zones import zone_findings
from tests.unit.planning.deck_cell import deck_scene

SCENE = deck_scene()
MOVES = [
    move
    for move in stated_moves(SCENE)
    # Those of procedure 103, of runs, and of heads: none of the views of a calibration, which are
    # many and near the measuring pose.
    if move.kind is MoveKind.JOINT
]


def found(monkeypatch: pytest.MonkeyPatch, scene: CellScene) -> list[str]:
    monkeypatch.setattr(check_zones, "stated_moves", lambda _scene: MOVES)
    return [str(one) for one in zone_findings(scene)]


def with_corner(zone: str, robot: str, corner: str, axis: int, value_mm: float) -> CellScene:
    """The shipped cell with one face of one box elsewhere."""
    config = SCENE.cell.zones[zone]
    share = config.robots[robot]
    moved = list(getattr(share, corner))
    moved[axis] = value_mm
    robots = config.robots | {robot: share.model_copy(update={corner: tuple(moved)})}
    zones = SCENE.cell.zones | {zone: config.model_copy(update={"robots": robots})}
    return replace(SCENE, cell=SCENE.cell.model_copy(update={"zones": zones}))


def test_the_shipped_zones_keep_apart_what_could_meet(monkeypatch: pytest.MonkeyPatch) -> None:
    assert found(monkeypatch, SCENE) == []


@pytest.mark.figures  # as a head that meets it is
def test_a_main_arm_that_may_stand_beside_its_box_and_meet_a_head_is_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = with_corner("beside_head_2", "main", "min_mm", 1, 300.0)
    (text,) = found(monkeypatch, scene)
    for part in ("F133", "beside_head_2", "main.gripper", "aux_2.head at measuring", "main is"):
        assert part in text


def test_a_head_that_may_stand_beside_its_box_and_meet_the_main_arm_is_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # So that its pose over the station, beside which a run works on purpose, is in the box still.
    scene = with_corner("beside_head_2", "aux_2", "min_mm", 0, 1850.0)
    (text,) = found(monkeypatch, scene)
    for part in ("beside_head_2", "aux_2.head", "aux_2 is between", "mm of its base"):
        assert part in text


def test_a_body_between_two_places_that_are_looked_at_is_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The main arm turns by 0.9°, outside of its boxes; half way its tip meets one of head 2."""
    main, aux = SCENE.arms["main"], SCENE.arms["aux_2"]
    home_rad, measuring_rad = main.taught_rad("home"), aux.taught_rad("measuring")
    turn_rad = np.radians([0.45, 0.0, 0.0, 0.0, 0.0, 0.0])
    tip = RigidTransform.from_translation([0.0, 0.0, 0.3]).as_matrix()
    at_head = np.linalg.inv(aux.link_frames(measuring_rad)[6]) @ main.link_frames(home_rad)[6] @ tip
    ball = CapsuleShape(0.0025, 0.0)
    tips = (
        Solid("main.tip", "main", 6, tip, ball, 0.0, stand_in=False),
        Solid("aux_2.tip", "aux_2", 6, at_head, ball, 0.0, stand_in=False),
    )
    there = StatedPlace("here", measuring_rad), StatedPlace("there", measuring_rad + 1e-5)
    ends = [StatedPlace(str(sign), home_rad + sign * turn_rad) for sign in (-1, 1)]
    moves = [
        StatedMove("main", MoveKind.JOINT, ends[0], ends[1], {}),
        StatedMove("aux_2", MoveKind.JOINT, *there, {}),
    ]
    monkeypatch.setattr(check_zones, "stated_moves", lambda _scene: moves)
    third = [solid for solid in SCENE.solids if solid.arm == "aux_1"]
    scene = replace(SCENE, solids=(*tips, *third))
    apart = scene.around("main", {"aux_2": [Standpoint("here", tuple(measuring_rad))]})
    for end in ends:
        assert end.joints_rad is not None
        assert apart.narrowest(end.joints_rad).slack_m > 0.005
    (text,) = [str(one) for one in zone_findings(scene)]
    assert "main.tip and aux_2.tip at between here and there" in text


def test_arms_that_share_no_zone_are_left_to_their_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = replace(SCENE, cell=SCENE.cell.model_copy(update={"zones": {}}))
    assert found(monkeypatch, scene) == []
