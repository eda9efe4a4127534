"""What `cellctl check` says of a recipe, and the plan that is made of it."""

from typing import Any, cast

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.peg_in_hole.checks import recipe_issues
from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.plan.cycle_plan import cycle_plan
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.run import PegFacts
from cellctl.processes.peg_in_hole.search.face import TouchedFace
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.stations import PegCell, believed_frames, on_face, weight_of
from tests.rigs.shipped import shipped_cell

CELL = shipped_cell("insertion-pin.toml")
SETTINGS = cast(PegSettings, CELL.processes["peg-in-hole"])
RECIPE = cast(PegRecipe, CELL.recipes[0])


def changed(**sections: dict[str, Any]) -> PegRecipe:
    written = RECIPE.model_dump()
    for name, keys in sections.items():
        written[name] = {**written[name], **keys}
    return PegRecipe.model_validate(written)


def issues(recipe: PegRecipe) -> list[str]:
    return [str(issue) for issue in recipe_issues(CELL, recipe, "recipes.0")]


def test_the_shipped_recipe_is_good() -> None:
    assert issues(RECIPE) == []
    plan = cycle_plan(RECIPE, SETTINGS)
    assert plan.choice.order[0] is SearchName.SPIRAL, "its chamfers are wide"
    assert plan.task.fit.depth_m == pytest.approx(12e-3)
    assert plan.task.cell.stiffness_n_m == pytest.approx(1.2e5)
    # The loop is refused before anything moves when it cannot be held.
    cell = PegCell(None, None, SETTINGS)  # type: ignore[arg-type]  # figures alone
    assert PegFacts.of(cell, RECIPE, plan).contact.limit_n == 50.0


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"forces": {"search_n": 40.0}}, "search_n <= insertion_n < fault_n"),
        ({"forces": {"fault_n": 30.0}}, "search_n <= insertion_n < fault_n"),
        ({"seat": {"least_n": 30.0}}, "least_n < most_n"),
    ],
)
def test_what_cannot_be_is_named(sections: dict[str, Any], words: str) -> None:
    assert any(words in issue for issue in issues(changed(**sections)))


def test_a_search_that_does_not_suit_the_hole_is_named() -> None:
    (issue,) = issues(RECIPE.model_copy(update={"search": SearchName.ARC}))
    assert "the hole has no outer face" in issue


@pytest.mark.parametrize(
    "sections",
    [
        {"fit": {"clearance_mm": 0.0}},
        {"fit": {"friction": 1.0}},
        {"base_T_hole": {"uncertainty_mm": float("nan")}},
        {"load": {"mass_kg": 0.0}},
    ],
)
def test_no_number_beyond_its_bounds(sections: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        changed(**sections)


def test_frame_a_lies_on_the_touched_face_and_the_peg_stands_upright_on_it() -> None:
    above = pose_from_xyzabc((500.0, -200.0, 415.0, 0.0, 0.0, 180.0))
    frames = believed_frames(RECIPE, above)
    tip = frames.tip(above)
    np.testing.assert_allclose(tip, [0, 0, -15e-3, 0, 0, 0], atol=1e-9)
    face = TouchedFace(0.4e-3, np.array([0.02, -0.01]), 0.0, 1e-3)
    moved = on_face(frames, face)
    np.testing.assert_allclose(frames.base_T_flange(tip).as_matrix(), above.as_matrix(), atol=1e-9)
    # Points of the touched plane have no depth in the new frame.
    for x, y in ((5e-3, 0.0), (0.0, 5e-3), (-3e-3, 4e-3)):
        point = np.array([x, y, face.depth_m + face.slope @ [x, y]])
        in_base = frames.base_T_task.apply(point)
        assert moved.base_T_task.inv().apply(in_base)[2] == pytest.approx(0.0, abs=2e-6)
    upright = moved.base_T_flange(np.zeros(6)) * moved.flange_T_tip
    into_hole = upright.rotation.apply([0.0, 0.0, 1.0])
    normal = moved.base_T_task.rotation.apply([0.0, 0.0, 1.0])
    np.testing.assert_allclose(into_hole, normal, atol=1e-9)


def test_the_weight_is_taken_out_at_any_tilt() -> None:
    compensation = weight_of(RECIPE)
    level = RigidTransform.identity().rotation
    load = compensation.load(level)
    np.testing.assert_allclose(load[:3], [0, 0, -1.1 * 9.80665], atol=1e-9)
    # 60 mm along z and 2 mm along y: the weight makes a moment about x only.
    np.testing.assert_allclose(load[3:], [-0.002 * 1.1 * 9.80665, 0, 0], atol=1e-9)
