"""Turns the gripper's marks over camera II, about the last joint alone."""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.interfaces import Camera
from cellctl.processes.antenna_module.chain.teaching.tool_turn import TurnStop
from cellctl.processes.antenna_module.connector.marks import Marks
from cellctl.processes.antenna_module.facts import PluggingFacts
from cellctl.processes.antenna_module.faults.connector import MarksMissing
from cellctl.processes.antenna_module.faults.plugging import LooksIncomplete
from cellctl.processes.antenna_module.looking import Eyes, Seen, image_file, marks_by
from cellctl.processes.antenna_module.moves.kept_look import KeptLook
from cellctl.processes.antenna_module.moves.moving import Mover
from cellctl.processes.antenna_module.moves.places import turned
from cellctl.processes.antenna_module.recipe import Place
from cellctl.processes.antenna_module.roles import INSPECT_PLUG
from cellctl.processes.antenna_module.vision.measurement import MeasuredMarks
from cellctl.vision.camera.single_camera import SingleCamera


@dataclass(frozen=True, slots=True)
class Eye:
    """A camera and what is known of its lens."""

    camera: Camera
    model: SingleCamera


@dataclass(frozen=True, slots=True)
class TurnDrive:
    """What turning needs of a run or a procedure; the gripper is open and empty."""

    facts: PluggingFacts
    eyes: Eyes
    mover: Mover
    kept: list[KeptLook] = field(default_factory=list)
    """What was looked at, for the record."""

    async def stop(self, angle_rad: float, name: str) -> TurnStop:
        """Turn there and look: marks less reported flange axis, in the axes of the base.

        ``angle_rad`` is from the taught pose over camera II. Raises ``LooksIncomplete`` where the
        marks are not seen, and what moves and images raise.
        """
        over_camera = np.radians(self.facts.cell.arm.config.poses_deg[INSPECT_PLUG])
        await self.mover.to_joints(turned(over_camera, angle_rad))
        return await self._marks(name, angle_rad)

    async def _marks(self, name: str, angle_rad: float) -> TurnStop:
        facts, cell = self.facts, self.facts.cell
        recipe, base_T_cam2 = facts.recipe, facts.plug_cell.cam2.pose.pose
        place = Place(pose=recipe.flange_T_plug, height_sigma_mm=recipe.plug_height_sigma_mm)
        base_T_plug = cell.arm.robot.state().base_T_flange * pose_from_xyzabc(recipe.flange_T_plug)
        expected = base_T_cam2.inv() * base_T_plug
        eye, marks = camera_2_of(facts), facts.drawings.gripper
        seen = await look_at_marks(self.eyes, name, eye, marks, expected=expected, place=place)
        self.kept.append(
            kept_look(seen, eye, marks, expected=expected, place=place, angle_rad=angle_rad)
        )
        return turn_stop(angle_rad, base_T_cam2 * first_pose(seen), seen.base_T_flange)


def turn_stop(
    angle_rad: float, base_T_marks: RigidTransform, base_T_flange: RigidTransform
) -> TurnStop:
    """Marks as they were seen less the reported flange axis, in the axes of the base."""
    seen_m = base_T_marks.translation - base_T_flange.translation
    return TurnStop(angle_rad, np.asarray(seen_m[:2]))


def camera_2_of(facts: PluggingFacts) -> Eye:
    """Camera II with its intrinsics."""
    return Eye(facts.cell.camera_2, facts.camera_2)


async def look_at_marks(
    eyes: Eyes, name: str, eye: Eye, marks: Marks, *, expected: RigidTransform, place: Place
) -> Seen[MeasuredMarks]:
    """Marks in a plane that lies as ``expected``, in the camera, and is as certain as ``place``.

    Raises ``LooksIncomplete`` where they are not seen.
    """
    measure = marks_by(eye.model, marks, expected, place)
    try:
        return await eyes.look(name, eye.camera, measure)
    except MarksMissing as fault:
        raise LooksIncomplete(f"{marks.name}: {fault.detail}") from fault


def kept_look(
    seen: Seen[MeasuredMarks],
    eye: Eye,
    marks: Marks,
    *,
    expected: RigidTransform,
    place: Place,
    angle_rad: float = 0.0,
) -> KeptLook:
    """A look as ``look_at_marks`` took it, for the record."""
    image = image_file(seen.look)
    return KeptLook(image, eye.model, marks, expected, place, seen.base_T_flange, angle_rad)


def first_pose(seen: Seen[MeasuredMarks]) -> RigidTransform:
    """camera_T_marks of the first frame."""
    return seen.frames[0].camera_T_marks.pose
