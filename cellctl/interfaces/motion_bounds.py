"""What the driver of a robot refuses, as its settings state it."""

from dataclasses import dataclass

from cellctl.geometry.box import Box


@dataclass(frozen=True, slots=True, eq=False)
class MotionBounds:
    """Bounds of one arm; None where the settings of its driver say nothing of it."""

    flange_box: Box | None = None
    """Where the flange may be sent, in the robot base."""
    joint_speed_ratio: float | None = None
    """Greatest share of the rated speed in joint moves."""
    speed_m_s: float | None = None
    """Greatest speed of the flange in straight moves."""
    acceleration_m_s2: float | None = None
    load_kg: float | None = None
    """Greatest load at the flange."""
