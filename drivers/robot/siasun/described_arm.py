"""What the settings of an arm say of it before it is connected, whatever its controller speaks."""

from typing import Any, ClassVar

from cellctl.geometry.arm.chain import ArmChain
from cellctl.geometry.box import Box
from cellctl.geometry.pose import MM
from cellctl.interfaces.motion_bounds import MotionBounds
from cellctl.interfaces.robot import ForwardKinematics, Robot
from drivers.robot.siasun.kinematics import arm_chain
from drivers.robot.siasun.published import published_reach_m


class DescribedArm(Robot):
    """Answers by the settings, which are ``MotionLimits``."""

    most_load_kg: ClassVar[float | None] = None
    """Greatest load of any arm with this driver; None where the driver is for arms of many
    sizes."""

    @classmethod
    def checks_joint_ways(cls, config: Any) -> bool:
        """True with a dh table in the settings: without one no way can be computed."""
        return config.dh is not None

    @classmethod
    def bounds(cls, config: Any) -> MotionBounds:
        """The bounds that the settings state, in SI units."""
        return MotionBounds(
            flange_box=Box.from_mm(config.workspace_min_mm, config.workspace_max_mm),
            joint_speed_ratio=config.max_joint_speed_percent / 100,
            speed_m_s=config.max_speed_mm_s * MM,
            acceleration_m_s2=config.max_acceleration_mm_s2 * MM,
            load_kg=cls.most_load_kg,
        )

    @classmethod
    def forward_kinematics(cls, config: Any) -> ForwardKinematics | None:
        """Pose of the flange by joint angles, from the dh table of the settings; None without a
        table."""
        chain = arm_chain(config)
        return None if chain is None else chain.base_T_flange

    @classmethod
    def chain(cls, config: Any) -> ArmChain | None:
        """The arm by the dh table and the joint limits of the settings; None without a table."""
        return arm_chain(config)

    @classmethod
    def published_reach_m(cls, config: Any) -> float | None:
        """By the model with which the robot's name begins; None where the settings have no name."""
        return published_reach_m(getattr(config, "robot_name", ""))
