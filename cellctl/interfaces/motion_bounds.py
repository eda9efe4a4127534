"""What the driver of a robot refuses, as its settings state it."""

from dataclasses import dataclass

from cellctl.geometry.box import Box


@dataclass(frozen=True, slots=True, eq=False)
class MotionBounds:
    """Bounds of one arm; None where the settings of its driver say nothing of it."""

    flange_box: Box | None = None
    """In the robot base: where the flange may be sent."""
    joint_speed_ratio: float | None = None
    """Of the rated speed, for joint moves."""
    speed_m_s: float | None = None
    """Of the flange in straight moves."""
    acceleration_m_s2: float | None = None
    load_kg: float | None = None
    """Greatest load at the flange."""
