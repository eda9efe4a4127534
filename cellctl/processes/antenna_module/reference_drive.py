"""Drives past the references of the cell: gripper marks over camera II, plate under camera I."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array, pose_from_xyzabc
from cellctl.interfaces import Camera
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.chain.reference_looks import ReferenceLooks, turn_angles
from cellctl.processes.antenna_module.chain.tool_turn import TurnStop
from cellctl.processes.antenna_module.connector.marks import Marks
from cellctl.processes.antenna_module.drawings import Plate
from cellctl.processes.antenna_module.facts import PluggingFacts
from cellctl.processes.antenna_module.faults.connector import MarksMissing
from cellctl.processes.antenna_module.faults.plugging import LooksIncomplete
from cellctl.processes.antenna_module.looking import Eyes, Seen, nominal, plane_by
from cellctl.processes.antenna_module.moving import Mover
from cellctl.processes.antenna_module.recipe import Place
from cellctl.processes.antenna_module.roles import INSPECT_PLUG, REFERENCE_LOOK
from cellctl.processes.antenna_module.vision.measure import measure_marks
from cellctl.processes.antenna_module.vision.measurement import MeasuredMarks
from cellctl.vision.camera.single_camera import SingleCamera

_FROM_BELOW = RigidTransform.from_rotation(Rotation.from_euler("x", 180, degrees=True))
_LAST_JOINT = 5

Tell = Callable[[int, int], Awaitable[None]]
"""Told the number of the look that is next, and that of the last one."""


@dataclass(frozen=True, slots=True)
class ReferenceDrive:
    """What the drive needs of a run or a procedure."""

    facts: PluggingFacts
    plate: Plate
    eyes: Eyes
    tell: Tell

    async def looks(self, count: int, *, first: int = 1) -> ReferenceLooks:
        """``count`` looks at the marks and as many of camera I at the plate.

        Marks and plate in turn: each look has an approach of its own, and its share of how badly
        the arm repeats. Ends over the plate; pictures are numbered from ``first``. Raises
        ``LooksIncomplete`` where marks are not seen, and what moves and images raise.
        """
        mover = Mover(self.facts.cell)
        turns: list[TurnStop] = []
        plate_in_1: list[Array] = []
        plate_in_2: list[Array] = []
        lever_m = 0.0
        for number, angle_rad in enumerate(turn_angles(count), start=first):
            await self.tell(number, first + count - 1)
            await mover.to_joints(self._turned(angle_rad))
            turns.append(await self._marks(f"reference-{number}-marks", angle_rad))
            await mover.to_taught(REFERENCE_LOOK)
            place_m, away_m = await self._plate_from_above(f"reference-{number}-above")
            plate_in_1.append(place_m)
            lever_m = max(lever_m, away_m)
            if number == first:
                # The arm is not in it: a second look would only repeat the first one.
                plate_in_2.append(await self._plate_from_below(f"reference-{number}-below"))
        return ReferenceLooks(tuple(turns), tuple(plate_in_1), tuple(plate_in_2), lever_m)

    def _turned(self, angle_rad: float) -> Array:
        """Joints with the gripper over camera II, the last one turned."""
        joints = np.radians(self.facts.cell.arm.config.poses_deg[INSPECT_PLUG])
        # Towards the middle of the joint's range: half a turn outwards may be beyond it.
        inwards = -1.0 if joints[_LAST_JOINT] > 0 else 1.0
        joints[_LAST_JOINT] += inwards * angle_rad
        return np.asarray(joints)

    async def _marks(self, name: str, angle_rad: float) -> TurnStop:
        """Marks less reported flange axis, in the axes of the base."""
        facts, cell = self.facts, self.facts.cell
        recipe, base_T_cam2 = facts.recipe, facts.plug_cell.cam2.pose.pose
        place = Place(pose=recipe.flange_T_plug, height_sigma_mm=recipe.plug_height_sigma_mm)
        base_T_plug = cell.arm.robot.state().base_T_flange * pose_from_xyzabc(recipe.flange_T_plug)
        expected = base_T_cam2.inv() * base_T_plug
        seen = await self._look(name, self._camera_2, facts.drawings.gripper, expected, place)
        marks_m = (base_T_cam2 * _first(seen)).translation
        return TurnStop(angle_rad, np.asarray((marks_m - seen.base_T_flange.translation)[:2]))

    async def _plate_from_above(self, name: str) -> tuple[Array, float]:
        """Its place in the axes of the base, and how far it is from the flange, m."""
        facts, cell, place = self.facts, self.facts.cell, self.plate.base_T_plate
        flange_T_cam1 = facts.plug_cell.cam1.pose.pose
        base_T_cam1 = cell.arm.robot.state().base_T_flange * flange_T_cam1
        expected = base_T_cam1.inv() * nominal(place)
        eye = _Eye(cell.camera_1, facts.camera_1)
        seen = await self._look(name, eye, self.plate.above, expected, place)
        flange_T_plate = flange_T_cam1 * _first(seen)
        place_m = (seen.base_T_flange * flange_T_plate).translation[:2]
        return np.asarray(place_m), float(np.linalg.norm(flange_T_plate.translation))

    async def _plate_from_below(self, name: str) -> Array:
        place = self.plate.base_T_plate
        base_T_cam2 = self.facts.plug_cell.cam2.pose.pose
        expected = base_T_cam2.inv() * nominal(place) * _FROM_BELOW
        seen = await self._look(name, self._camera_2, self.plate.below, expected, place)
        return np.asarray((base_T_cam2 * _first(seen)).translation[:2])

    @property
    def _camera_2(self) -> "_Eye":
        return _Eye(self.facts.cell.camera_2, self.facts.camera_2)

    async def _look(
        self,
        name: str,
        eye: "_Eye",
        marks: Marks,
        expected: RigidTransform,
        place: Place,
    ) -> Seen[MeasuredMarks]:
        """Marks in a plane that lies as ``expected``, in the camera, and is as certain as
        ``place``."""
        measure: Callable[[Image], MeasuredMarks] = partial(
            measure_marks,
            camera=eye.model,
            calibration=plane_by(eye.model, expected, place),
            marks=marks,
        )
        try:
            return await self.eyes.look(name, eye.camera, measure)
        except MarksMissing as fault:
            raise LooksIncomplete(f"{marks.name}: {fault.detail}") from fault


@dataclass(frozen=True, slots=True)
class _Eye:
    camera: Camera
    model: SingleCamera


def _first(seen: Seen[MeasuredMarks]) -> RigidTransform:
    """camera_T_marks."""
    return seen.frames[0].camera_T_marks.pose
