"""Viewpoints of a random cell, planned there and looked at again by other libraries."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.planning.cells import DECKS_M, RandomCell, taught_at
from cellctl.config.stated.views import StatedHead, StatedMeasurement, StatedPart
from cellctl.geometry.pose import MM, Array
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.views.plan_viewpoints import (
    PlannedViews,
    ViewpointPlan,
    stated_measurements,
)
from cellctl.planning.views.prediction import part_in_cell
from cellctl.planning.ways.polyline import joints_at
from cellctl.vision.camera.stereo_head import CameraModel
from cellctl.vision.features.hole import Hole
from tests.rigs.mujoco_oracle import MujocoOracle


@dataclass(frozen=True, slots=True, eq=False)
class ViewedCell:
    """A random cell whose heads measure from where the plan puts them."""

    scene: CellScene
    """With the planned poses taught."""
    worst_share: float
    """The least certain component over its threshold, as predicted."""
    least_slack_mm: float
    """Smallest slack of either arm at its viewpoint, by MuJoCo; negative where a hole is not in
    both images by OpenCV's projection."""


def with_planned_views(drawn: RandomCell) -> ViewedCell:
    """Plan the viewpoints of a cell whose heads were taught for the frame where it is not.

    Raises ``PlanningError``.
    """
    scene = drawn.scene(follow=("main",))
    (stated,) = stated_measurements(scene)
    statement = _of_deck(stated, drawn.deck_m)
    views = ViewpointPlan(scene, statement).search()
    arms = dict(scene.arms)
    for head, viewpoint in zip(statement.heads, views.best.viewpoints, strict=True):
        arms[head.robot] = taught_at(arms[head.robot], head.pose, viewpoint.joints_rad)
    planned = scene.with_arms(arms)
    seen = _all_in_images(planned, views)
    slack_mm = _least_slack_m(planned, statement) / MM if seen else -1.0
    return ViewedCell(planned, views.best.predicted.worst, slack_mm)


def _of_deck(stated: StatedMeasurement, deck_m: tuple[float, float, float]) -> StatedMeasurement:
    """Holes as near to the corners of this deck as those of the shipped one are to its own."""
    inward_m = (np.array(DECKS_M[0]) - np.array(deck_m)) / 2.0
    inward_m[2] = 0.0

    def moved(hole: Hole) -> Hole:
        return replace(hole, position_m=hole.position_m - np.sign(hole.position_m) * inward_m)

    def on_deck(part: StatedPart) -> StatedPart:
        seen = {head: tuple(map(moved, holes)) for head, holes in part.seen.items()}
        return replace(part, seen=seen, further=tuple(map(moved, part.further)))

    return replace(stated, parts=tuple(map(on_deck, stated.parts)))


def _least_slack_m(scene: CellScene, stated: StatedMeasurement) -> float:
    """With the main arm wherever it holds or leaves a part that is measured."""
    oracle = MujocoOracle(scene)
    heads = {one.robot: scene.arms[one.robot].taught_rad(one.pose) for one in stated.heads}
    return min(
        oracle.narrowest_slack_m(robot, heads | standing, approach=True)
        for part in stated.parts
        for standing in [
            {name: joints_at(scene.arms[name], place) for name, place in part.others.items()}
        ]
        for robot in heads
    )


def _all_in_images(scene: CellScene, views: PlannedViews) -> bool:
    statement = views.placement.measurement
    bases = {name: arm.cell_T_base for name, arm in scene.arms.items()}
    return all(
        _in_images(scene, head, part_in_cell(part, bases).apply(_centres_m(part.seen[head.name])))
        for head in statement.heads
        for part in statement.parts
    )


def _in_images(scene: CellScene, head: StatedHead, points_m: Array) -> bool:
    """``points_m`` are those of rims in the cell, shape (n, 3)."""
    arm = scene.arms[head.robot]
    flange = arm.cell_T_base * arm.base_T_flange(arm.taught_rad(head.pose))
    in_left_m = (flange * head.flange_T_camera).inv().apply(points_m)
    turn = Rotation.from_matrix(head.camera.rotation).as_rotvec()
    left_px = _projected(head.camera.left, in_left_m, np.zeros(3), np.zeros(3))
    right_px = _projected(head.camera.right, in_left_m, turn, head.camera.translation_m)
    pixels = np.vstack([left_px, right_px])
    return bool((pixels > 0.0).all() and (pixels < np.array(head.camera.image_size)).all())


def _projected(camera: CameraModel, points_m: Array, turn: Array, move_m: Array) -> Array:
    # OpenCV takes rows in one piece only.
    rows_m = np.ascontiguousarray(points_m)
    found, _ = cv2.projectPoints(rows_m, turn, move_m, camera.camera_matrix, camera.distortion)
    return np.asarray(found.reshape(-1, 2))


def _centres_m(holes: tuple[Hole, ...]) -> Array:
    return np.array([hole.position_m for hole in holes])
