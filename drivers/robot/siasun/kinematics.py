"""The chain of an arm by the dh table of its settings."""

import numpy as np

from cellctl.geometry.arm.chain import ArmChain
from cellctl.geometry.pose import MM
from drivers.robot.siasun.config import MotionLimits


def arm_chain(config: MotionLimits) -> ArmChain | None:
    """The arm in SI units with the limits of its joints; None without a dh table."""
    if config.dh is None:
        return None
    scale = np.array([np.radians(1.0), MM, MM, np.radians(1.0)])
    return ArmChain(
        np.array(config.dh) * scale,
        np.radians(config.joints_min_deg),
        np.radians(config.joints_max_deg),
    )
