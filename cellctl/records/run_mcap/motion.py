"""What was recorded as it happened: robots, forces, states, registers."""

import json
import re
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

from cellctl.records.entries import Artefact
from cellctl.records.files.curve_file import is_curve
from cellctl.records.files.mcap_reading import RawMessage
from cellctl.records.files.unfinished import MOTION
from cellctl.records.run_mcap.frames import pose_in_frame, reported_transforms, robot_frames
from cellctl.records.run_mcap.message import RecordedJson, TimedMessage, nanoseconds
from cellctl.records.run_mcap.sources import RunSources

_SCHEMAS = (
    (re.compile(r"/robots/[^/]+/command"), "cellctl.RobotCommand"),
    (re.compile(r"/robots/[^/]+/report"), "cellctl.RobotReport"),
    (re.compile(r"/force/[^/]+/raw"), "cellctl.Force"),
    (re.compile(r"/contact/force"), "cellctl.ContactForce"),
    (re.compile(r"/unit/state"), "cellctl.UnitState"),
    (re.compile(r"/registers/(input|holding)"), "cellctl.Registers"),
)
_REPORT = re.compile(r"/robots/([^/]+)/report")
_COMMAND = re.compile(r"/robots/([^/]+)/command")


def recorded_motion(sources: RunSources) -> Iterator[TimedMessage]:
    """The recording of the run as it is, with poses for viewers beside it."""
    found = [one for one in sources.record.artefacts if one.name == MOTION]
    content = sources.recording(found[-1]) if found else None
    if not found:
        sources.missing.append(f"{MOTION}: robots, forces, states and registers")
    if content is None:
        return
    yield from _recorded(sources, content.messages)
    yield from _robot_poses(sources, content.messages)


def contact_forces(sources: RunSources) -> Iterator[TimedMessage]:
    """The force curve of each contact, gravity removed and tared."""
    for artefact in filter(is_curve, sources.record.artefacts):
        content = sources.recording(artefact)
        if content is not None and content.messages:
            late_ns = _late_ns(artefact, content.messages)
            yield from _recorded(sources, content.messages, late_ns)


def _late_ns(artefact: Artefact, messages: tuple[RawMessage, ...]) -> int:
    """By how much a curve is dated late.

    A curve cannot end after its file was stored. Such a file of the first releases has the end of
    the contact where its begin should stand.
    """
    first_ns, last_ns = messages[0].time_ns, messages[-1].time_ns
    return last_ns - first_ns if last_ns > nanoseconds(artefact.time) else 0


def _recorded(
    sources: RunSources, messages: tuple[RawMessage, ...], late_ns: int = 0
) -> Iterator[TimedMessage]:
    schemas: dict[str, str] = {}
    for message in messages:
        if message.topic not in schemas:
            schemas[message.topic] = _schema(message.topic)
            if not schemas[message.topic]:
                sources.missing.append(f"{message.topic}: recorded, and unknown to this release")
        if schema := schemas[message.topic]:
            content = RecordedJson(schema, message.data)
            yield TimedMessage(message.time_ns - late_ns, message.topic, content)


def _schema(topic: str) -> str:
    return next((name for pattern, name in _SCHEMAS if pattern.fullmatch(topic)), "")


def _robot_poses(sources: RunSources, messages: tuple[RawMessage, ...]) -> Iterator[TimedMessage]:
    reports: dict[str, list[RawMessage]] = defaultdict(list)
    for message in messages:
        if named := _REPORT.fullmatch(message.topic):
            reports[named[1]].append(message)
    frames = robot_frames(sources.record, reports)
    for name, found in reports.items():
        yield from reported_transforms(found, *frames[name])
    for message in messages:
        if named := _COMMAND.fullmatch(message.topic):
            name = named[1]
            base = frames.get(name, (f"{name}/base", ""))[0]
            yield from _commanded(name, base, message)


def _commanded(name: str, base: str, message: RawMessage) -> Iterator[TimedMessage]:
    values: dict[str, Any] = json.loads(message.data)
    target = values.get("base_T_flange_mm_deg")
    pose = None if target is None else pose_in_frame(message.time_ns, base, target)
    if pose is not None:
        yield TimedMessage(message.time_ns, f"/robots/{name}/target", pose)
