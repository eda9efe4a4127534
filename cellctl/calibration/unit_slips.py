"""Input files whose numbers look as if they were written in metres or radians.

For files of what a camera sees or an arm reaches: targets, boards and flanges, which are never all
within a few millimetres of the frame in which they are written.
"""

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import pose_from_xyzabc, pose_to_xyzabc

_LEAST_MM = 20.0
"""When every coordinate of a file is smaller, it was written in metres: no arm works within 20 mm
of its base."""
_JOINTS = "joints_deg"
_LARGEST_RAD = 2.0 * math.pi
"""When every joint of a file is smaller, it was written in radians."""


def require_usual_units(file: str, content: object) -> None:
    """Raise ``FileInvalid`` for places that look like metres, and joints that look like radians.

    ``content`` is the file as it was written. Judged is the largest number of all places of one
    key, or of all joints in one table of the file: a single small one is none of these.
    """
    places: dict[str, float] = defaultdict(float)
    joints: dict[str, float] = defaultdict(float)
    for table, tables_content in _tables(content):
        for key, numbers in _vectors(tables_content, table):
            largest = max(abs(number) for number in numbers)
            if key == _JOINTS:
                joints[table] = max(joints[table], largest)
            else:
                places[key] = max(places[key], largest)
    for key, largest in places.items():
        if 0.0 < largest < _LEAST_MM:
            raise FileInvalid(f"{file}: {key}: millimetres belong here; these look like metres")
    for table, largest in joints.items():
        if 0.0 < largest <= _LARGEST_RAD:
            where = _JOINTS if table == _JOINTS else f"{table}, {_JOINTS}"
            raise FileInvalid(f"{file}: {where}: degrees belong here; these look like radians")


def meant_in_radians(pose: RigidTransform) -> RigidTransform:
    """The pose whose angles were written in radians and read as degrees."""
    written = pose_to_xyzabc(pose)
    return pose_from_xyzabc([*written[:3], *np.degrees(written[3:])])


def written_in_radians(poses: Sequence[RigidTransform]) -> bool:
    """Whether no angle of these poses, read as degrees, is more than a turn in radians."""
    largest = max(float(np.abs(pose_to_xyzabc(pose)[3:]).max()) for pose in poses)
    return 0.0 < largest <= _LARGEST_RAD


def _tables(content: object) -> Iterator[tuple[str, object]]:
    """What stands under each key of the file."""
    if isinstance(content, Mapping):
        yield from ((str(name), value) for name, value in content.items())
    else:
        yield "", content


def _vectors(content: object, key: str) -> Iterator[tuple[str, Sequence[float]]]:
    """Joints, and the places of points and poses, each by the key under which it stands."""
    if isinstance(content, Mapping):
        for name, value in content.items():
            # A drawing has the names of its points for keys.
            yield from _vectors(value, key if key == "drawing_mm" else str(name))
    elif isinstance(content, list):
        yield from _of_list(content, key)


def _of_list(content: list[Any], key: str) -> Iterator[tuple[str, Sequence[float]]]:
    # The rows of a covariance are no places: a good one is all small numbers.
    if "covariance" in key:
        return
    if _is_matrix(content):
        yield key, [float(row[3]) for row in content[:3]]
    elif _are_numbers(content):
        if key == _JOINTS:
            yield key, content
        elif len(content) == 6 or (len(content) == 3 and key in ("position_mm", "drawing_mm")):
            yield key, content[:3]
    else:
        for one in content:
            yield from _vectors(one, key)


def _is_matrix(rows: list[Any]) -> bool:
    return len(rows) == 4 and all(
        isinstance(row, list) and len(row) == 4 and _are_numbers(row) for row in rows
    )


def _are_numbers(values: list[Any]) -> bool:
    return bool(values) and all(
        isinstance(value, int | float) and not isinstance(value, bool) for value in values
    )
