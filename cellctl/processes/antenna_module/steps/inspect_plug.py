"""Step 40: camera II sees the plug and the marks on the gripper in one picture."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, pose_error, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.looks import PlugLook
from cellctl.processes.antenna_module.faults.connector import ConnectorMisplaced
from cellctl.processes.antenna_module.faults.plugging import GrippedOffTwice
from cellctl.processes.antenna_module.looking import Seen, combined, connector_by
from cellctl.processes.antenna_module.mated import connector_T_plug
from cellctl.processes.antenna_module.recipe import Place
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.record.pictures import record_picture
from cellctl.processes.antenna_module.roles import INSPECT_PLUG
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import Picked, PlugInspected
from cellctl.processes.antenna_module.steps.grip_again import grip_again
from cellctl.processes.antenna_module.steps.look_again import SecondLook
from cellctl.processes.antenna_module.steps.putting_back import put_back_bad
from cellctl.processes.antenna_module.vision.measurement import (
    BAD_CONTACTS,
    ConnectorMeasurement,
    require_sound,
)
from cellctl.processes.antenna_module.vision.result_file import result_to_json
from cellctl.records.figures import Limit


@dataclass(frozen=True, slots=True, eq=False)
class _PlugSight:
    """A plug with all of its contacts, and the marks beside it."""

    seen: Seen[ConnectorMeasurement]
    plug: UncertainPose
    """``camera_T_connector``, combined from all frames."""
    marks: UncertainPose
    """``camera_T_marks``."""


async def inspect_plug(picked: Picked) -> PlugInspected:
    """Show the plug to camera II and measure it; what is gripped off its place is gripped again.

    A module with a bad contact goes back onto its tray. Raises ``GrippedOffTwice``,
    ``ContactMissing``, ``ContactBent``, ``ContactHidden``, and the other faults of
    ``measure_connector``.
    """
    run = picked.run
    try:
        sight, regrips = await _sound(picked, "plug"), 0
    except ConnectorMisplaced as first:
        # Nothing else asks for a second grip: a force fault says that the module has met something.
        picked = await grip_again(picked, first)
        sight, regrips = await _sound_again(picked, first), 1
    await run.recorder.figure(keys.REGRIPS, regrips, "")
    seen, plug, marks = sight.seen, sight.plug, sight.marks
    look = PlugLook(
        base_T_flange=seen.base_T_flange,
        joints_rad=seen.joints_rad,
        time_s=seen.time_s,
        camera_id=run.facts.camera_2.id,
        camera_T_plug=_mated(run, plug),
        camera_T_marks=marks,
        connector=run.drawings.plug.name,
    )
    on_gripper = pose_from_xyzabc(run.recipe.flange_T_marks) * marks.pose.inv() * plug.pose
    await _record(run, seen, plug, marks, on_gripper)
    return PlugInspected(run, picked.module, plug=look, flange_T_connector=on_gripper)


async def _sound_again(picked: Picked, first: ConnectorMisplaced) -> _PlugSight:
    try:
        return await _sound(picked, "plug-again")
    except ConnectorMisplaced as second:
        raise GrippedOffTwice(f"first {first.detail}; then {second.detail}") from second


async def _sound(picked: Picked, images: str) -> _PlugSight:
    run = picked.run
    await run.mover.to_taught_over(INSPECT_PLUG)
    try:
        return await SecondLook(run).look(images, partial(_look, run))
    except BAD_CONTACTS:
        # It has met nothing, so the way back is free.
        await put_back_bad(picked)
        raise


async def _look(run: PluggingRun, images: str) -> _PlugSight:
    base_T_flange = run.cell.arm.robot.state().base_T_flange
    place = Place(
        pose=run.recipe.flange_T_plug,
        within_mm=run.drawings.gripper.within_m / MM,
        within_deg=float(np.degrees(run.drawings.gripper.within_rad)),
        height_sigma_mm=run.recipe.plug_height_sigma_mm,
    )
    base_T_connector = base_T_flange * pose_from_xyzabc(run.recipe.flange_T_plug)
    expected = run.facts.plug_cell.cam2.pose.pose.inv() * base_T_connector
    drawings = run.drawings
    measure = connector_by(run.facts.camera_2, drawings.plug, expected, place, drawings.gripper)
    seen = await run.eyes.look(images, run.cell.camera_2, measure)
    # Before the judgement: a bad contact is what somebody wants to see.
    await record_picture(run, keys.PLUG_PICTURE, seen)
    for frame in seen.frames:
        require_sound(frame)
    plug = combined(tuple(frame.camera_T_connector for frame in seen.frames))
    marks = combined(tuple(frame.marks.camera_T_marks for frame in seen.frames if frame.marks))
    return _PlugSight(seen, plug, marks)


def _mated(run: PluggingRun, camera_T_connector: UncertainPose) -> UncertainPose:
    """The chain's frame of the plug, which coincides with the socket's once it is seated."""
    return camera_T_connector * UncertainPose.exact(connector_T_plug(run.drawings.socket))


async def _record(
    run: PluggingRun,
    seen: Seen[ConnectorMeasurement],
    plug: UncertainPose,
    marks: UncertainPose,
    on_gripper: RigidTransform,
) -> None:
    recorder, frames = run.recorder, len(seen.frames)
    await recorder.measurement(keys.PLUG, "cam2", "connector", plug, frames=frames)
    await recorder.measurement(keys.MARKS, "cam2", "marks", marks, frames=frames)
    await recorder.document(
        keys.PLUG_DETAIL, {"images": [result_to_json(frame) for frame in seen.frames]}
    )
    offset_m, turn_rad = pose_error(pose_from_xyzabc(run.recipe.flange_T_plug), on_gripper)
    gripper = run.drawings.gripper
    await recorder.figure(
        keys.GRIP_OFFSET,
        float(np.linalg.norm(offset_m[:2])) / MM,
        "mm",
        limit=Limit(upper=gripper.within_m / MM),
    )
    await recorder.figure(
        keys.GRIP_TURN,
        abs(float(np.degrees(turn_rad[2]))),
        "°",
        limit=Limit(upper=float(np.degrees(gripper.within_rad))),
    )
