"""What is asked of a move before it is sent and after it has ended, by the kind of its target."""

from collections.abc import Callable
from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.interfaces.robot import RobotState
from drivers.robot.siasun.arrival import Arrival
from drivers.robot.siasun.bounds import Bounds
from drivers.robot.siasun.config import MotionLimits


@dataclass(frozen=True, slots=True)
class MotionTarget:
    """One target of a move."""

    check_way: Callable[[RobotState], None]
    """Raises what forbids the way there from where the robot stands."""
    off: Callable[[RobotState], str | None]
    """How far from it the robot has ended, in words; None when it has arrived."""


class Targets:
    """Makes the targets of one robot."""

    def __init__(self, bounds: Bounds, config: MotionLimits) -> None:
        self._bounds = bounds
        self._arrival = Arrival(config)

    def joints(self, joints_rad: Array) -> MotionTarget:
        """The target of a joint move: joints of shape (6,)."""
        return MotionTarget(
            lambda state: self._bounds.joint_way(state, joints_rad),
            lambda state: self._arrival.off_joints(state, joints_rad),
        )

    def flange(self, base_T_flange: RigidTransform) -> MotionTarget:
        """The target of a straight move of the flange, of any length."""
        return MotionTarget(
            lambda state: self._bounds.linear_way(state, base_T_flange),
            lambda state: self._arrival.off_pose(state, base_T_flange),
        )
