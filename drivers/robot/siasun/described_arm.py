"""What the settings of an arm say of it before it is connected, whatever its controller speaks."""

from typing import Any

from cellctl.geometry.arm.chain import ArmChain
from cellctl.interfaces.robot import ForwardKinematics, Robot
from drivers.robot.siasun.kinematics import arm_chain


class DescribedArm(Robot):
    """Answers by the dh table of the settings, which are ``MotionLimits``."""

    @classmethod
    def checks_joint_ways(cls, config: Any) -> bool:
        """Only with a dh table in the configuration."""
        return config.dh is not None

    @classmethod
    def forward_kinematics(cls, config: Any) -> ForwardKinematics | None:
        """By the dh table of the configuration."""
        chain = arm_chain(config)
        return None if chain is None else chain.base_T_flange

    @classmethod
    def chain(cls, config: Any) -> ArmChain | None:
        """By the dh table and the joint limits of the configuration."""
        return arm_chain(config)
