"""Moves of the arm through free air, all of them under the force guard."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.free_moves import move_joint_free
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance, guarded_moves
from cellctl.config.stated.arm_places import ArmPlaces
from cellctl.errors.config import ArmNotDescribed
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.moves.places import raised
from cellctl.processes.antenna_module.stations import AntennaCell

FREE = WrenchTolerance(force_n=15.0, moment_n_m=4.0)
"""What gripper and module make of speeding up and slowing down, twice 1.5 kg at 0.4 m/s², and a few
newtons of hoses on a lever of 0.25 m."""
NEAR = WrenchTolerance(force_n=5.0, moment_n_m=1.5)
"""Tolerance of slow moves beside something that may be touched."""
SLOW_M_S, SLOW_M_S2 = 0.02, 0.05
"""Speed and acceleration of these moves: the load makes a fraction of a newton of them."""


@dataclass(frozen=True, slots=True)
class Mover:
    """The arm of one cell."""

    cell: AntennaCell

    async def to_taught(self, pose: str) -> None:
        """A joint move to a taught pose."""
        await self.to_joints(np.radians(self.cell.arm.config.poses_deg[pose]))

    async def to_taught_over(self, pose: str) -> None:
        """To a taught pose by joints, from no lower than that one.

        Joints go obliquely: from below, what hangs in the gripper would pass what stands beside the
        pose lower than it is shown there.
        """
        arm = self.cell.arm
        places = ArmPlaces(self.cell.cell.config, arm.sensor.mounted_on)
        here = arm.robot.state().base_T_flange
        try:
            taught = places.flange_at(places.taught(pose))
        except ArmNotDescribed:
            # Without its kinematics nobody knows how high the pose is: as somebody has tried it.
            taught = here
        climb_m = float(taught.translation[2] - here.translation[2])
        if climb_m > 0.0:
            await self.to(raised(here, climb_m))
        await self.to_taught(pose)

    async def to_joints(self, joints_rad: Array) -> None:
        """A joint move, shape (6,)."""
        arm = self.cell.arm
        # The weight is not identified: what the arm's tilt makes of it is part of the tolerance.
        await arm.guard.set_gravity_compensation(GravityCompensation.none())
        await move_joint_free(self.cell.cell, arm, joints_rad)

    async def to(self, base_T_flange: RigidTransform) -> None:
        """A straight move at the taught speed."""
        config = self.cell.arm.config
        speed_m_s, acceleration_m_s2 = (
            config.linear_speed_mm_s * MM,
            config.linear_acceleration_mm_s2 * MM,
        )
        await self._straight(base_T_flange, speed_m_s, acceleration_m_s2, FREE)

    async def slowly_to(self, base_T_flange: RigidTransform) -> None:
        """A straight move beside something that may be touched."""
        await self._straight(base_T_flange, SLOW_M_S, SLOW_M_S2, NEAR)

    async def _straight(
        self,
        base_T_flange: RigidTransform,
        speed_m_s: float,
        acceleration_m_s2: float,
        tolerance: WrenchTolerance,
    ) -> None:
        arm = self.cell.arm
        frame = RigidTransform.identity()
        async with guarded_moves(self.cell.cell, arm, frame, tolerance) as move:
            await move(
                arm.robot.move_linear(
                    base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=acceleration_m_s2
                )
            )
