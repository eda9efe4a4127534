"""Chooses the places of two heads by how certain the pose that counts will be."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from cellctl.config.process_definition import process_definition
from cellctl.config.stated.views import StatedMeasurement
from cellctl.errors.config import NoViewpoint
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.views.head_search import HeadSearch, Viewpoint
from cellctl.planning.views.looks import HeadLook, grid_of_looks
from cellctl.planning.views.prediction import (
    PredictedPose,
    ViewGeometry,
    part_in_cell,
    predicted_pose,
)
from cellctl.planning.ways.travel import travel_s

Pair = tuple[Viewpoint, Viewpoint]

_KEPT = 8
"""Places of each head that are combined with those of the other."""
_STEPS = (1.0, 0.5, 0.25)
"""Width of each round of the refinement, in steps of the grid."""
_ALIKE = 1.01
"""Predictions that differ by less are one: then the shorter way decides."""
_APART_M, _APART_RAD = 0.05, float(np.radians(10.0))
"""Runners-up differ by more than this from the best and from each other."""
_RUNNERS_UP = 3
"""How many other pairs are shown besides the best."""


@dataclass(frozen=True, slots=True, eq=False)
class PlannedPair:
    """Both heads at one place each."""

    viewpoints: Pair
    predicted: PredictedPose
    time_s: float
    """Time of the slower arm from the pose that the cell file has first beside the measuring
    one."""


@dataclass(frozen=True, slots=True, eq=False)
class PlannedViews:
    """What was found for one measurement."""

    placement: ViewGeometry
    """Where the heads stand with the best pair."""
    best: PlannedPair
    runners_up: tuple[PlannedPair, ...]
    taught: PlannedPair
    """The pair of poses in the cell file, whether its heads see their holes or not."""
    refused: tuple[Counter[str], Counter[str]]
    """Why places were refused, for each head."""


def stated_measurements(scene: CellScene) -> Iterator[StatedMeasurement]:
    """The measurements of all recipes."""
    for recipe in scene.cell.recipes:
        definition = process_definition(recipe.process)
        yield from definition.measurements(scene.cell, recipe, scene.folder)


def taught_placement(scene: CellScene, measurement: StatedMeasurement) -> ViewGeometry:
    """Both heads where the cell file has them.

    Raises ``HeadNotDescribed`` or ``PlaceUnreachable``.
    """
    one, two = (HeadSearch.of(scene, measurement, number) for number in (0, 1))
    bases = {name: arm.cell_T_base for name, arm in scene.arms.items()}
    return ViewGeometry(
        measurement,
        tuple(part_in_cell(part, bases) for part in measurement.parts),
        (one.taught().cell_T_camera, two.taught().cell_T_camera),
        (one.limits.quality, two.limits.quality),
        measurement.frames,
    )


class ViewpointPlan:
    """The search for one measurement."""

    def __init__(
        self,
        scene: CellScene,
        measurement: StatedMeasurement,
        grid: Sequence[HeadLook] | None = None,
    ) -> None:
        """``grid``: from where to look beside the taught pose; None for all directions.

        Raises ``HeadNotDescribed`` or ``PlaceUnreachable``.
        """
        self._grid = grid
        self._scene = scene
        self._measurement = measurement
        self._heads = (
            HeadSearch.of(scene, measurement, 0),
            HeadSearch.of(scene, measurement, 1),
        )
        self._placement = taught_placement(scene, measurement)
        self._taught = self._heads[0].taught(), self._heads[1].taught()

    def search(self) -> PlannedViews:
        """The best pair of places with its runners-up; raises ``NoViewpoint``."""
        ones, twos = self._candidates(0), self._candidates(1)
        pairs = sorted(
            (self._rated(pair) for pair in product(ones, twos) if self._together(pair)),
            key=lambda pair: pair.predicted.worst,
        )
        if not pairs:
            raise NoViewpoint(
                f"{self._measurement.label}: each head has places, and at no two of them both can "
                "stand and see at once"
            )
        best = self._refined(_quickest(pairs))
        others = [pair for pair in pairs if pair is not best]
        return PlannedViews(
            self._placed(best.viewpoints),
            replace(best, predicted=predicted_pose(self._placed(best.viewpoints), explain=True)),
            tuple(_different(best, others)),
            self._rated(self._taught),
            (self._heads[0].refused, self._heads[1].refused),
        )

    def _candidates(self, number: int) -> list[Viewpoint]:
        """The best places of one head while the other is where it is taught."""
        search = self._heads[number]
        grid = self._grid
        if grid is None:
            grid = list(grid_of_looks(search.limits.nearest_m, search.limits.farthest_m))
        looks = list(search.seeing((self._taught[number].look, *grid)))
        looks.sort(key=lambda look: self._predicted_with(number, look).worst)
        kept: list[Viewpoint] = []
        for look in looks:
            found = search.viewpoint(look)
            if found is not None:
                kept.append(found)
            if len(kept) == _KEPT:
                break
        if not kept:
            reasons = ", ".join(f"{count} x {why}" for why, count in search.refused.most_common())
            raise NoViewpoint(f"{search.head.name}: {reasons}")
        return kept

    def _predicted_with(self, number: int, look: HeadLook) -> PredictedPose:
        cameras = list(self._placement.cell_T_cameras)
        cameras[number] = self._heads[number].camera_at(look)
        return predicted_pose(replace(self._placement, cell_T_cameras=(cameras[0], cameras[1])))

    def _placed(self, pair: Pair) -> ViewGeometry:
        cameras = pair[0].cell_T_camera, pair[1].cell_T_camera
        return replace(self._placement, cell_T_cameras=cameras)

    def _rated(self, pair: Pair) -> PlannedPair:
        predicted = predicted_pose(self._placed(pair))
        times_s = [
            self._way_s(search, viewpoint)
            for search, viewpoint in zip(self._heads, pair, strict=True)
        ]
        return PlannedPair(pair, predicted, max(times_s))

    def _way_s(self, search: HeadSearch, viewpoint: Viewpoint) -> float:
        arm = self._scene.arms[search.head.robot]
        starts = [name for name in arm.config.poses_deg if name != search.head.pose]
        if not starts:
            return 0.0
        return travel_s(arm, np.vstack([arm.taught_rad(starts[0]), viewpoint.joints_rad]))

    def _together(self, pair: Pair) -> bool:
        """Whether both can be there at once, and neither hides anything from the other."""
        for search, own, other, beside in (
            (self._heads[0], pair[0], self._heads[1], pair[1]),
            (self._heads[1], pair[1], self._heads[0], pair[0]),
        ):
            robot = other.head.robot
            if not search.has_room_beside(own, robot, beside.joints_rad):
                search.refused[f"{robot} is too near, or in its zone"] += 1
                return False
            why = search.hidden(own, {robot: beside.joints_rad})
            if why is not None:
                search.refused[why] += 1
                return False
        return True

    def _refined(self, best: PlannedPair) -> PlannedPair:
        """One number of one head changed at a time, as long as it helps."""
        for step in _STEPS:
            better: PlannedPair | None = best
            while better is not None:
                best = better
                better = self._improved(best, step)
        return best

    def _improved(self, best: PlannedPair, step: float) -> PlannedPair | None:
        for number in (0, 1):
            for look in best.viewpoints[number].look.neighbours(step):
                cameras = list(self._placed(best.viewpoints).cell_T_cameras)
                cameras[number] = self._heads[number].camera_at(look)
                placement = replace(self._placement, cell_T_cameras=(cameras[0], cameras[1]))
                # The prediction first: it is quicker than looking whether the arm can stand there.
                if predicted_pose(placement).worst * _ALIKE > best.predicted.worst:
                    continue
                found = self._heads[number].viewpoint(look)
                if found is None:
                    continue
                first, second = best.viewpoints
                pair = (found, second) if number == 0 else (first, found)
                if self._together(pair):
                    return self._rated(pair)
        return None


def _quickest(pairs: Sequence[PlannedPair]) -> PlannedPair:
    """The pair that takes the least time, of those that are as good as the best."""
    alike = [one for one in pairs if one.predicted.worst <= _ALIKE * pairs[0].predicted.worst]
    return min(alike, key=lambda pair: pair.time_s)


def _different(best: PlannedPair, pairs: Sequence[PlannedPair]) -> Iterator[PlannedPair]:
    taken = [best]
    for pair in pairs:
        if len(taken) > _RUNNERS_UP:
            return
        if all(_apart(pair, other) for other in taken):
            taken.append(pair)
            yield pair


def _apart(one: PlannedPair, other: PlannedPair) -> bool:
    for mine, theirs in zip(one.viewpoints, other.viewpoints, strict=True):
        between = mine.cell_T_camera.inv() * theirs.cell_T_camera
        if float(np.linalg.norm(between.translation)) > _APART_M:
            return True
        if between.rotation.magnitude() > _APART_RAD:
            return True
    return False
