"""What the run has found: poses, passes of the loop, figures."""

import re
from collections.abc import Iterator
from dataclasses import asdict

from cellctl.records.entries import RecordedPose, RunRecord
from cellctl.records.run_mcap.frames import WRITTEN, pose_in_frame
from cellctl.records.run_mcap.message import JsonValues, TimedMessage, nanoseconds

_NOT_IN_A_TOPIC = re.compile(r"[^\w.-]+")


def poses(record: RunRecord) -> Iterator[TimedMessage]:
    """Measured, commanded and reported poses at the time of their recording."""
    for pose in record.poses:
        time_ns = nanoseconds(pose.time)
        yield TimedMessage(time_ns, "/poses", JsonValues("cellctl.Pose", _values(pose)))
        placed = pose_in_frame(time_ns, pose.parent, pose.pose_mm_deg)
        if placed is not None:
            key = _NOT_IN_A_TOPIC.sub("_", pose.key)
            yield TimedMessage(time_ns, f"/poses/{pose.origin}/{key}", placed)


def _values(pose: RecordedPose) -> dict[str, object]:
    return {
        "key": pose.key,
        "origin": str(pose.origin),
        "parent": pose.parent,
        "child": pose.child,
        **dict(zip(WRITTEN, pose.pose_mm_deg, strict=True)),
        "sigma_mm_deg": pose.sigma_mm_deg,
        "residual_um": pose.residual_um,
        "frames": pose.frames,
        "detail": dict(pose.detail),
    }


def passes(record: RunRecord) -> Iterator[TimedMessage]:
    """Error, uncertainty, limit and correction of each component, by its name."""
    for one in record.passes:
        components = {
            component.name: {
                "unit": component.unit,
                "value": component.value,
                "sigma": component.sigma,
                "limit": component.limit,
                "correction": component.correction,
            }
            for component in one.components
        }
        values = {
            "loop": one.loop,
            "number": one.number,
            "converged": one.converged,
            "residual_um": one.residual_um,
            "frames": one.frames,
            "components": components,
        }
        yield TimedMessage(nanoseconds(one.time), "/passes", JsonValues("cellctl.LoopPass", values))


def figures(record: RunRecord) -> Iterator[TimedMessage]:
    """Each figure when it was recorded."""
    for one in record.figures:
        values = asdict(one)
        del values["time"], values["phase"]
        yield TimedMessage(nanoseconds(one.time), "/figures", JsonValues("cellctl.Figure", values))
