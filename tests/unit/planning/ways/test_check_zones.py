"""Boxes of the shipped zones, larger ones and smaller ones, against what could meet beside them."""

from dataclasses import replace

import pytest

from cellctl.config.stated.moves import MoveKind
from cellctl.planning.scene.cell_scene import CellScene
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


def test_arms_that_share_no_zone_are_left_to_their_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = replace(SCENE, cell=SCENE.cell.model_copy(update={"zones": {}}))
    assert found(monkeypatch, scene) == []
