"""Frames as a viewer needs them: a tree, in which every frame has one parent."""

import json
import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.records.entries import Calibration, PoseOrigin, RunRecord
from cellctl.records.files.mcap_reading import RawMessage
from cellctl.records.run_mcap.message import TimedMessage, nanoseconds, stamp

TF = "/tf"
_TRANSFORM = re.compile(r"(\w+)_T_(\w+)")
_SAME_POSE_MM = 0.02
"""A pose that was recorded and the report that it came from differ by their rounding."""
WRITTEN = ("x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg")
Numbers = Iterable[float | None]


def pose_in_frame(time_ns: int, frame: str, xyz_abc_mm_deg: Numbers) -> PoseInFrame | None:
    """A written pose in a frame; None when a component is unknown."""
    pose = written(xyz_abc_mm_deg)
    if pose is None:
        return None
    position, orientation = _components(pose.translation, pose.rotation.as_quat())
    placed = Pose(position=position, orientation=orientation)
    return PoseInFrame(timestamp=stamp(time_ns), frame_id=frame, pose=placed)


def reported_transforms(
    reports: Sequence[RawMessage], parent: str, child: str
) -> Iterator[TimedMessage]:
    """``parent_T_child`` at each report of a robot that has all six numbers."""
    read = ((report.time_ns, json.loads(report.data)) for report in reports)
    rows = [(time_ns, [values[name] for name in WRITTEN]) for time_ns, values in read]
    known = [(time_ns, row) for time_ns, row in rows if None not in row]
    table = np.array([row for _, row in known], float).reshape(-1, 6)
    # All at once: the library takes a millisecond for each call, and a run has thousands.
    rotations = Rotation.from_euler("ZYX", table[:, 3:], degrees=True).as_quat()
    for (time_ns, _), place, quaternion in zip(known, table[:, :3] * MM, rotations, strict=True):
        yield _transform(time_ns, parent, child, place, quaternion)


def _transform(
    time_ns: int, parent: str, child: str, place_m: Array, quaternion: Array
) -> TimedMessage:
    translation, rotation = _components(place_m, quaternion)
    one = FrameTransform(
        timestamp=stamp(time_ns),
        parent_frame_id=parent,
        child_frame_id=child,
        translation=translation,
        rotation=rotation,
    )
    return TimedMessage(time_ns, TF, FrameTransforms(transforms=[one]))


def written(xyz_abc_mm_deg: Numbers) -> RigidTransform | None:
    """A pose from its written form; None when a component is unknown."""
    values = list(xyz_abc_mm_deg)
    if any(value is None for value in values):
        return None
    return pose_from_xyzabc(np.array(values, float))


def calibrated_frames(
    calibrations: Iterable[Calibration], record: RunRecord
) -> Iterator[TimedMessage]:
    """Transforms that the calibrations of the run state, named by their keys: ``base_T_c1``.

    A frame gets the first parent that is stated, since a tree has no place for a second one.
    """
    start_ns, placed = nanoseconds(record.head.started), set[str]()
    for calibration in calibrations:
        for key, value in calibration.record.items():
            named = _TRANSFORM.fullmatch(key)
            matrix = value.get("matrix_mm") if isinstance(value, Mapping) else None
            # What stands above ``base`` would make a second root of it.
            if named is None or matrix is None or named[2] in placed | {"base"}:
                continue
            placed.add(named[2])
            rows = np.array(matrix, float)
            quaternion = Rotation.from_matrix(rows[:3, :3]).as_quat()
            yield _transform(start_ns, named[1], named[2], rows[:3, 3] * MM, quaternion)


def robot_frames(
    record: RunRecord, reports: Mapping[str, list[RawMessage]]
) -> dict[str, tuple[str, str]]:
    """Names of base and flange of each robot in the tree.

    The record names the base and the flange of the robot that a process works with, and not which
    robot that is. It is the one that has reported what the record says; all others get their own
    names before theirs.
    """
    frames = {name: (f"{name}/base", f"{name}/flange") for name in reports}
    for pose in record.poses:
        place = written(pose.pose_mm_deg)
        if pose.origin is not PoseOrigin.REPORTED or place is None:
            continue
        time_ns = nanoseconds(pose.time)
        near = {name: _nearest(found, time_ns) for name, found in reports.items() if found}
        same = [name for name, values in near.items() if _same(values, pose.pose_mm_deg)]
        if len(same) == 1:
            return frames | {same[0]: (pose.parent, pose.child)}
    return frames


def _nearest(reports: list[RawMessage], time_ns: int) -> Mapping[str, Any]:
    # The pose was asked for while the robot stood, and recorded a little later.
    after = bisect_right(reports, time_ns, key=lambda report: report.time_ns)
    values: dict[str, Any] = json.loads(reports[max(0, after - 1)].data)
    return values


def _same(report: Mapping[str, Any], recorded: Numbers) -> bool:
    """Whether a robot has reported this place; False where either does not say it."""
    pairs = [(report[name], value) for name, value in zip(WRITTEN[:3], recorded, strict=False)]
    return all(
        None not in (one, other) and abs(one - other) < _SAME_POSE_MM for one, other in pairs
    )


def _components(place_m: Array, quaternion: Array) -> tuple[Vector3, Quaternion]:
    x, y, z = place_m.tolist()
    qx, qy, qz, qw = quaternion.tolist()
    return Vector3(x=x, y=y, z=z), Quaternion(x=qx, y=qy, z=qz, w=qw)
