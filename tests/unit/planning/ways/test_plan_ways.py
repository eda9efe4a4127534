"""Ways of the shipped cell and of cells that were disturbed, verified by another library."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.config import load_cell
from cellctl.errors.config import PlaceUnreachable, PlanningError
from cellctl.planning.model.shapes import BoxShape
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.solid import Solid
from cellctl.planning.ways.plan_ways import PlannedWay, plan_ways, with_ways
from cellctl.planning.ways.write_ways import with_ways_written
from tests.rigs.mujoco_oracle import MujocoOracle
from tests.unit.planning.deck_cell import DECK, deck_scene

BODY_STEP_M = 0.01
"""Between two looks of the oracle no body moves further; `make campaign-planning` looks each mm."""


def main_way(scene: CellScene, seed: int = 1) -> PlannedWay:
    return next(iter(plan_ways(scene, seed=seed, search_s=40.0)))


def least_slack_m(scene: CellScene, way: PlannedWay) -> float:
    oracle = MujocoOracle(scene)
    lever_m = scene.around("main", {}).lever_m
    heads = {name: scene.arms[name].taught_rad("measuring") for name in ("aux_1", "aux_2")}
    slacks = []
    for start, end in zip(way.joints_rad[:-1], way.joints_rad[1:], strict=True):
        count = 2 + int(np.abs(end - start) @ lever_m / BODY_STEP_M)
        for at_rad in np.linspace(start, end, count):
            slacks.append(oracle.narrowest_slack_m("main", {**heads, "main": at_rad}))
    return min(slacks)


def box_at(place_m: tuple[float, float, float], size_m: float = 0.2) -> Solid:
    pose = RigidTransform.from_translation(place_m).as_matrix()
    return Solid("obstacle", None, 0, pose, BoxShape((size_m,) * 3), 0.0, stand_in=False)


@pytest.mark.figures
def test_a_way_around_the_heads_is_found_and_free_by_another_library() -> None:
    scene = deck_scene()
    way = main_way(scene)
    assert len(way.joints_rad) > 2
    assert least_slack_m(scene, way) > -1e-4


def test_what_is_written_is_what_was_planned_and_the_file_is_still_a_good_one(
    tmp_path: Path,
) -> None:
    scene = deck_scene()
    arm, stated = scene.arms["main"], scene.cell.robots["main"].ways[0]
    via_rad = np.radians(stated.via_deg) + np.radians(1.0)
    joints_rad = np.vstack([arm.taught_rad(stated.start), via_rad, arm.taught_rad(stated.end)])
    narrowest = scene.around("main", {}).narrowest(joints_rad[0])
    way = PlannedWay("main", stated.start, stated.end, joints_rad, narrowest, 1.0)
    text = with_ways_written(DECK.read_text(encoding="utf-8"), [way])
    assert "# The fake cell." in text
    written = tmp_path / "deck.toml"
    written.write_text(text, encoding="utf-8")
    for folder in ("features", "demo-calibration"):
        (tmp_path / folder).symlink_to((DECK.parent / folder).resolve())
    cell = load_cell(written)
    assert cell.robots["main"].ways == way.written()
    assert with_ways(scene, [way]).cell.robots["main"].ways == way.written()
    assert with_ways_written(text, []).count("[[robots.main.ways]]") == 0


@pytest.mark.long
def test_the_same_seed_gives_the_same_way() -> None:
    # Two scenes, for the first search may leave something in its own.
    first, second = (main_way(deck_scene.__wrapped__(), seed=3) for _ in range(2))
    assert np.array_equal(first.joints_rad, second.joints_rad)


def test_an_end_that_is_not_free_is_refused_with_the_reason() -> None:
    scene = deck_scene()
    flange = scene.arms["main"].base_T_flange(scene.arms["main"].taught_rad("home"))
    blocked = replace(scene, solids=(*scene.solids, box_at(tuple(flange.translation))))
    with pytest.raises(PlanningError, match="obstacle"):
        main_way(blocked)


def test_an_end_in_a_zone_in_which_another_arm_stands_is_refused_without_a_search() -> None:
    scene = deck_scene()
    zone = scene.cell.zones["beside_head_2"]
    everywhere = {"min_mm": (-9e3, -9e3, -9e3), "max_mm": (9e3, 9e3, 9e3)}
    shares = {name: share.model_copy(update=everywhere) for name, share in zone.robots.items()}
    zones = {"beside_head_2": zone.model_copy(update={"robots": shares})}
    closed = replace(scene, cell=scene.cell.model_copy(update={"zones": zones}))
    with pytest.raises(PlaceUnreachable, match=r"comes into zone beside_head_2"):
        main_way(closed)
