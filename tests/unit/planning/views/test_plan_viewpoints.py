from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.config import load_cell
from cellctl.errors.config import NoViewpoint
from cellctl.planning.views.gains import gains
from cellctl.planning.views.looks import HeadLook
from cellctl.planning.views.plan_viewpoints import PlannedViews, ViewpointPlan
from cellctl.planning.views.standing import reaches_views
from cellctl.planning.views.view_text import gain_line, views_lines
from cellctl.planning.views.write_viewpoints import with_viewpoints_written
from tests.unit.planning.deck_cell import DECK
from tests.unit.planning.views.deck_views import SCENE, measurement, with_limits

TILTED = [
    HeadLook(0.48, sign * 0.25, sign * 0.25, roll) for sign in (1.0, -1.0) for roll in (0.0, np.pi)
]
"""Looks that are better than the taught ones, of which a whole search finds more."""


@pytest.fixture(scope="module")
def planned() -> PlannedViews:
    return ViewpointPlan(SCENE, measurement(), TILTED).search()


def test_the_worst_component_gets_better(planned: PlannedViews) -> None:
    assert planned.best.predicted.worst < 0.8 * planned.taught.predicted.worst


def test_both_heads_stand_free_beside_each_other(planned: PlannedViews) -> None:
    one, two = (viewpoint.joints_rad for viewpoint in planned.best.viewpoints)
    gap = SCENE.around("aux_1", {}).narrowest(one)
    assert gap.slack_m >= 0.0
    flange = SCENE.arms["aux_2"].base_T_flange(two)
    mounted = measurement().heads[1].flange_T_camera
    camera = SCENE.arms["aux_2"].cell_T_base * flange * mounted
    between = camera.inv() * planned.best.viewpoints[1].cell_T_camera
    assert np.allclose(between.as_matrix(), np.eye(4), atol=1e-7)


def test_from_where_a_head_is_to_measure_it_can_be_calibrated(planned: PlannedViews) -> None:
    for head, viewpoint in zip(measurement().heads, planned.best.viewpoints, strict=True):
        assert len(head.flange_T_views) == 23
        arm = SCENE.arms[head.robot]
        assert reaches_views(arm, viewpoint.joints_rad, head.flange_T_views)
    far = (RigidTransform.from_translation([0.0, 0.0, -3.0]),)
    stated = measurement()
    one, two = (replace(head, flange_T_views=far) for head in stated.heads)
    with pytest.raises(NoViewpoint, match="a view of the calibration is out of reach"):
        ViewpointPlan(SCENE, replace(stated, heads=(one, two)), TILTED[:1]).search()


def test_the_text_names_what_limits_and_what_would_help(planned: PlannedViews) -> None:
    text = "\n".join(views_lines(planned))
    for part in ("now:", "planned:", "what limits about x", "images", "places refused"):
        assert part in text
    found = {gain.change: gain for gain in gains(SCENE, planned.placement)}
    (twice,) = [gain for change, gain in found.items() if "second head" in change]
    assert twice.predicted.worst < planned.best.predicted.worst
    assert any("baseline" in change for change in found)
    assert "of its threshold" in gain_line(twice)


def test_planned_poses_are_written_and_nothing_else(planned: PlannedViews, tmp_path: Path) -> None:
    text = with_viewpoints_written(DECK.read_text(encoding="utf-8"), [planned])
    before = DECK.read_text(encoding="utf-8").splitlines()
    changed = [line for line in text.splitlines() if line not in before]
    assert len(changed) == 2
    assert all(line.startswith("measuring = [") for line in changed)
    out = tmp_path / "deck.toml"
    out.write_text(text, encoding="utf-8")
    for folder in ("features", "demo-calibration"):
        (tmp_path / folder).symlink_to((DECK.parent / folder).resolve())
    joints = load_cell(out).robots["aux_1"].poses_deg["measuring"]
    assert np.degrees(planned.best.viewpoints[0].joints_rad) == pytest.approx(joints, abs=1e-3)


def test_heads_that_see_nothing_from_anywhere_are_refused_with_the_reasons() -> None:
    scene = with_limits(nearest_m=2.0, farthest_m=2.5)
    with pytest.raises(NoViewpoint, match=r"head_1: 5 x a hole is out of focus"):
        ViewpointPlan(scene, measurement(), TILTED).search()


def test_the_measurement_is_certain_enough_as_the_process_asks(planned: PlannedViews) -> None:
    statement = planned.placement.measurement
    assert planned.best.predicted.worst <= statement.share
    strict = replace(statement, share=0.01)
    views = replace(planned, placement=replace(planned.placement, measurement=strict))
    assert any("NOT certain enough" in line for line in views_lines(views))
