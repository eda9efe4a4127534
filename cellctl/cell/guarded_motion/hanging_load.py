"""Whether the wrench before a tare can be what hangs on the sensor, and nothing else."""

import numpy as np

from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.config.driver_settings import measuring_range
from cellctl.errors.force import TareImplausible
from cellctl.force.gravity.gravity_compensation import GRAVITY_M_S2, gravity_in_sensor
from cellctl.geometry.pose import Array

LEVER_M = 0.5
"""No load hangs farther from the sensor than this."""
OFFSET_SHARE = 0.02
"""Share of its range that a sensor without any load may read, in each axis: a strain gauge bridge
is balanced to about half of that, and the rest is hoses."""


def require_hanging(arm: GuardedRobot, untared: Array) -> None:
    """Raise ``TareImplausible`` unless a load at rest makes this wrench: (6,), in sensor axes.

    What is taken as zero is not seen any more, so it may be the weight of what hangs there and the
    sensor's own offset. With the ``load`` of the robot's section the force must point along gravity
    and be no more than that weight; less is an empty gripper. Without one, nobody knows more than
    that the weight is below ``free_force_n``. The robot is taken as one that stands level.
    """
    force_n, moment_n_m = untared[:3], float(np.linalg.norm(untared[3:]))
    load = arm.config.load
    offset_n, offset_n_m = _offset(arm)
    if load is None:
        most_n, doubt_n = arm.sensor.free_force_n, 0.0
        _require("the force", float(np.linalg.norm(force_n)), most_n, "N")
    else:
        most_n = (load.mass_kg - load.not_weighed_kg) * GRAVITY_M_S2
        doubt_n = load.tolerance_kg * GRAVITY_M_S2 + offset_n
        base_R_sensor = arm.robot.state().base_T_flange.rotation * arm.flange_T_sensor.rotation
        down = gravity_in_sensor(base_R_sensor)
        along_n = float(down @ force_n)
        across_n = float(np.linalg.norm(force_n - along_n * down))
        _require("the force downwards", along_n, most_n + doubt_n, "N")
        _require("the force upwards", -along_n, doubt_n, "N")
        _require("the force across gravity", across_n, doubt_n, "N")
    _require("the moment", moment_n_m, (most_n + doubt_n) * LEVER_M + offset_n_m, "N·m")


def _require(what: str, value: float, most: float, unit: str) -> None:
    # So that a value that is no number is refused too.
    if not value <= most:
        raise TareImplausible(
            f"{what} is {value:.1f} {unit} with nothing subtracted, of what hangs on the sensor "
            f"and its offset at most {most:.1f} {unit}"
        )


def _offset(arm: GuardedRobot) -> tuple[float, float]:
    """What the sensor may read by itself: N, N·m."""
    sensor = arm.sensor
    measuring = measuring_range(sensor)
    # A driver that names no range: its limits stand for it, which lie within the range.
    forces = measuring[:3] or [sensor.free_force_n]
    moments = measuring[3:] or [sensor.free_moment_n_m]
    return OFFSET_SHARE * max(forces), OFFSET_SHARE * max(moments)
