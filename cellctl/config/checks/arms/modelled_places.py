"""Places of a recipe at which the model of the cell has nothing.

Planning takes every way for free that leads through what the model lacks. So where something is to
be touched or gripped there has to be a body.
"""

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.config.model_file import ModelBox, StatedModel
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc

_NEAR_MM = 10.0
"""Bodies are drawn to millimetres, and a pocket or a chamfer lies before them."""


def unmodelled_issues(
    model: StatedModel, robot: str, written: WrittenValue, base_T_place: RigidTransform
) -> Iterator[ConfigIssue]:
    """``written`` has its place in the base of a robot, ``base_T_place``; none of the fixtures is
    there.

    Nothing is said where the model has fixtures of other shapes than boxes, which are not read
    here, or none at all: such a model is of the arms alone.
    """
    if robot not in model.bases or not model.boxes_alone or not model.fixtures:
        return
    cell_T_place = pose_from_xyzabc(model.bases[robot]) * base_T_place
    away_mm = {box.name: _away_mm(box, cell_T_place.translation) for box in model.fixtures}
    name, least_mm = min(away_mm.items(), key=lambda item: item[1])
    if least_mm <= _NEAR_MM:
        return
    allowed = (
        f"a place within {_NEAR_MM:g} mm of a body of fixtures in {model.file}; {name} is nearest, "
        f"{least_mm:.0f} mm away. Ways through what the model lacks are called free"
    )
    yield ConfigIssue(written.key, written.value, allowed)


def _away_mm(box: ModelBox, place_m: Array) -> float:
    """Distance of a place from a box in the same frame; 0 inside."""
    inside_mm = pose_from_xyzabc(box.at).inv().apply(place_m) / MM
    beyond_mm = np.maximum(np.abs(inside_mm) - np.array(box.size_mm) / 2.0, 0.0)
    return float(np.linalg.norm(beyond_mm))
