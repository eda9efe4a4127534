"""Drives past the references of the cell: gripper marks over camera II, plate under camera I."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.reference.reference_looks import (
    ReferenceLooks,
    turn_angles,
)
from cellctl.processes.antenna_module.chain.teaching.tool_turn import TurnStop
from cellctl.processes.antenna_module.drawings import Plate
from cellctl.processes.antenna_module.facts import PluggingFacts
from cellctl.processes.antenna_module.looking import Eyes, nominal
from cellctl.processes.antenna_module.moves.kept_look import KeptLook
from cellctl.processes.antenna_module.moves.moving import Mover
from cellctl.processes.antenna_module.moves.turning import (
    Eye,
    TurnDrive,
    camera_2_of,
    first_pose,
    kept_look,
    look_at_marks,
)
from cellctl.processes.antenna_module.roles import REFERENCE_LOOK

_FROM_BELOW = RigidTransform.from_rotation(Rotation.from_euler("x", 180, degrees=True))

Tell = Callable[[int, int], Awaitable[None]]
"""Told the number of the look that is next, and that of the last one."""


@dataclass(frozen=True, slots=True)
class KeptLooks:
    """The looks of one drive, in the order in which they were taken."""

    marks: list[KeptLook] = field(default_factory=list)
    """Camera II at the gripper's marks."""
    above: list[KeptLook] = field(default_factory=list)
    """Camera I at the plate."""
    below: list[KeptLook] = field(default_factory=list)
    """Camera II at the plate."""


@dataclass(frozen=True, slots=True)
class ReferenceDrive:
    """What the drive needs of a run or a procedure."""

    facts: PluggingFacts
    plate: Plate
    eyes: Eyes
    tell: Tell
    kept: KeptLooks = field(default_factory=KeptLooks)
    """What was looked at, for the record."""

    async def looks(self, count: int, *, first: int = 1) -> ReferenceLooks:
        """``count`` looks at the marks and as many of camera I at the plate.

        Marks and plate in turn: each look has an approach of its own, and its share of how badly
        the arm repeats. Ends over the plate; pictures are numbered from ``first``. Raises
        ``LooksIncomplete`` where marks are not seen, and what moves and images raise.
        """
        mover = Mover(self.facts.cell)
        turning = TurnDrive(self.facts, self.eyes, mover, self.kept.marks)
        turns: list[TurnStop] = []
        plate_in_1: list[Array] = []
        plate_in_2: list[Array] = []
        lever_m = 0.0
        for number, angle_rad in enumerate(turn_angles(count), start=first):
            await self.tell(number, first + count - 1)
            turns.append(await turning.stop(angle_rad, f"reference-{number}-marks"))
            await mover.to_taught(REFERENCE_LOOK)
            place_m, away_m = await self._plate_from_above(f"reference-{number}-above")
            plate_in_1.append(place_m)
            lever_m = max(lever_m, away_m)
            if number == first:
                # The arm is not in it: a second look would only repeat the first one.
                plate_in_2.append(await self._plate_from_below(f"reference-{number}-below"))
        return ReferenceLooks(tuple(turns), tuple(plate_in_1), tuple(plate_in_2), lever_m)

    async def _plate_from_above(self, name: str) -> tuple[Array, float]:
        """Its place in the axes of the base, and how far it is from the flange, m."""
        facts, cell, place = self.facts, self.facts.cell, self.plate.base_T_plate
        base_T_cam1 = facts.plug_cell.base_T_cam1(cell.arm.robot.state().base_T_flange)
        expected = base_T_cam1.inv() * nominal(place)
        eye = Eye(cell.camera_1, facts.camera_1)
        marks = self.plate.above
        seen = await look_at_marks(self.eyes, name, eye, marks, expected=expected, place=place)
        self.kept.above.append(kept_look(seen, eye, marks, expected=expected, place=place))
        base_T_plate = facts.plug_cell.base_T_cam1(seen.base_T_flange) * first_pose(seen)
        return plate_from_above(base_T_plate, seen.base_T_flange)

    async def _plate_from_below(self, name: str) -> Array:
        place = self.plate.base_T_plate
        base_T_cam2 = self.facts.plug_cell.cam2.pose.pose
        expected = base_T_cam2.inv() * nominal(place) * _FROM_BELOW
        eye, marks = camera_2_of(self.facts), self.plate.below
        seen = await look_at_marks(self.eyes, name, eye, marks, expected=expected, place=place)
        self.kept.below.append(kept_look(seen, eye, marks, expected=expected, place=place))
        return np.asarray((base_T_cam2 * first_pose(seen)).translation[:2])


def plate_from_above(
    base_T_plate: RigidTransform, base_T_flange: RigidTransform
) -> tuple[Array, float]:
    """x and y of the plate in the axes of the base, and how far it is from the flange, m."""
    plate_m = base_T_plate.translation
    away_m = float(np.linalg.norm(plate_m - base_T_flange.translation))
    return np.asarray(plate_m[:2]), away_m
