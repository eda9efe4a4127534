"""Each condition refuses by its own name, and the taught poses of the shipped cell meet all."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.config import HeadNotDescribed
from cellctl.planning.model.shapes import BoxShape
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.solid import Solid
from cellctl.planning.views import seeing, standing
from cellctl.planning.views.head_search import HeadSearch
from cellctl.planning.views.looks import HeadLook
from tests.unit.planning.views.deck_views import SCENE, measurement, with_limits


def search(scene: CellScene = SCENE, number: int = 0) -> HeadSearch:
    return HeadSearch.of(scene, measurement(), number)


def refusal(scene: CellScene, look: HeadLook | None = None) -> str:
    found = search(scene)
    assert found.viewpoint(look or found.taught().look) is None
    ((why, count),) = found.refused.items()
    assert count == 1
    return why


@pytest.mark.parametrize("number", [0, 1])
def test_the_taught_poses_see_everything(number: int) -> None:
    found = search(number=number)
    viewpoint = found.viewpoint(found.taught().look)
    assert viewpoint is not None, found.refused
    assert viewpoint.joints_rad == pytest.approx(found.taught().joints_rad, abs=1e-6)


def test_what_is_seen_badly_is_refused() -> None:
    look = search().taught().look
    assert refusal(with_limits(nearest_m=0.6)) == seeing.OUT_OF_FOCUS
    assert refusal(with_limits(margin_px=700.0)) == seeing.OUT_OF_PICTURE
    assert refusal(with_limits(greatest_angle_rad=0.1)) == seeing.TOO_OBLIQUE
    assert refusal(with_limits(lit_within_rad=0.05)) == seeing.UNLIT
    away = replace(look, shift_x_m=look.shift_x_m + 0.3)
    assert refusal(with_limits(greatest_angle_rad=1.2), away) == seeing.OUT_OF_PICTURE


def test_a_deep_rim_is_hidden_by_its_bore() -> None:
    statement = measurement()
    part = statement.parts[-1]
    deep = tuple(
        replace(hole, countersink_m=hole.countersink_m and hole.diameter_m + 0.2e-3)
        for hole in part.seen["head_1"]
    )
    parts = (replace(part, seen={**part.seen, "head_1": deep}),)
    found = HeadSearch.of(SCENE, replace(statement, parts=parts), 0)
    assert found.viewpoint(found.taught().look) is None
    assert set(found.refused) == {seeing.HIDDEN_BY_BORE}


def test_a_post_before_a_hole_is_named() -> None:
    found = search()
    (hole, *_), camera = found.parts[0].places_m, found.taught().cell_T_camera.translation
    pose = RigidTransform.from_translation(hole + 0.5 * (camera - hole)).as_matrix()
    post = Solid("post", None, 0, pose, BoxShape((0.01,) * 3), 0.0, stand_in=False)
    assert refusal(replace(SCENE, solids=(*SCENE.solids, post))) == "post hides P1"


def test_a_body_at_the_head_is_named() -> None:
    flange = search().taught().cell_T_camera * search().head.flange_T_camera.inv()
    pose = (flange * RigidTransform.from_translation([0.0, 0.0, -0.5])).as_matrix()
    block = Solid("block", None, 0, pose, BoxShape((0.2,) * 3), 0.0, stand_in=False)
    why = refusal(replace(SCENE, solids=(*SCENE.solids, block)))
    assert why.startswith("aux_1.")
    assert why.endswith("is too near to block")


def test_a_place_that_the_arm_cannot_hold_is_refused() -> None:
    arm, look = SCENE.arms["aux_1"], search().taught().look
    away = replace(arm, cell_T_base=RigidTransform.from_translation([9.0, 0.0, 0.0]))
    scene = replace(SCENE, arms={**SCENE.arms, "aux_1": away})
    assert refusal(scene, look) == standing.OUT_OF_REACH
    careful = replace(arm, joint_margin_rad=np.radians(90.0))
    assert refusal(replace(SCENE, arms={**SCENE.arms, "aux_1": careful})) == standing.NEAR_A_LIMIT


def test_a_head_that_the_model_does_not_have_is_a_fault() -> None:
    with pytest.raises(HeadNotDescribed, match="head_1"):
        search(replace(SCENE, heads={}))
