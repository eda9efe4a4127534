"""Poses for payload identification: a cone around the orientation in which contact is made.

Twelve poses within 10° to 15° of that orientation give a better compensation there than poses in
all directions, although those have the better condition number: the errors of a real sensor grow
with the range that is used, and with kilonewtons on it they outweigh the noise. The arm tilts about
*horizontal axes of the base*; tilts about tool axes can leave gravity unmoved in the sensor.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array

GOLDEN_ANGLE_RAD = np.pi * (3.0 - np.sqrt(5.0))
"""Turned by this angle from point to point, no two of any number of points lie in one direction."""


class PoseRole(Enum):
    """The purpose for which a pose is recorded."""

    FIT = "fit"
    HOLD_OUT = "hold-out"
    REPEAT = "repeat"
    """The first pose once more, at the end, which shows drift."""


@dataclass(frozen=True, slots=True)
class IdentificationPose:
    """One pose of the flange."""

    base_T_flange: RigidTransform
    role: PoseRole


def plan_identification(
    base_T_flange: RigidTransform,
    *,
    pivot_in_flange_m: Array,
    half_angle_rad: float = float(np.deg2rad(12.0)),
    fit_poses: int = 12,
    hold_out_poses: int = 4,
) -> tuple[IdentificationPose, ...]:
    """Poses in the order to drive them: fit (the given pose first), hold-out, then a repeat.

    The arm tilts about the point ``pivot_in_flange_m`` (shape (3,)), which stays where it is. With
    the middle of the gripped part as the pivot, the part sweeps the least room. Twelve poses are
    the knee: simulated with 200 kg, 4, 8, 12, 24 poses leave 5.9, 5.2, 4.8 and 4.5 N.
    """
    tilts = [np.zeros(2), *_disc(fit_poses - 1, half_angle_rad, turn_rad=0.0)]
    # Inside the cone and between the poses of the fit: the test is to interpolate, as the mating
    # does, not to extrapolate.
    held_out = _disc(hold_out_poses, 0.8 * half_angle_rad, turn_rad=1.0)
    poses = [
        IdentificationPose(_tilted(base_T_flange, tilt, pivot_in_flange_m), role)
        for role, group in ((PoseRole.FIT, tilts), (PoseRole.HOLD_OUT, held_out))
        for tilt in group
    ]
    return (*poses, IdentificationPose(base_T_flange, PoseRole.REPEAT))


def _disc(count: int, radius: float, turn_rad: float) -> list[Array]:
    """Points that fill a disc evenly up to its rim (sunflower), as tilts about base x and y."""
    index = np.arange(1, count + 1)
    # The square root gives equal areas to equal numbers of points; without it they crowd in the
    # middle.
    distance = radius * np.sqrt(index / max(count, 1))
    azimuth = index * GOLDEN_ANGLE_RAD + turn_rad
    return list(np.column_stack([distance * np.cos(azimuth), distance * np.sin(azimuth)]))


def _tilted(
    base_T_flange: RigidTransform, tilt_rad: Array, pivot_in_flange_m: Array
) -> RigidTransform:
    # About axes of the base: only such tilts are sure to move gravity in the sensor, whatever the
    # gripper looks like.
    tilt = Rotation.from_rotvec([tilt_rad[0], tilt_rad[1], 0.0])
    rotation = tilt * base_T_flange.rotation
    pivot_in_base = base_T_flange.apply(pivot_in_flange_m)
    return RigidTransform.from_components(
        pivot_in_base - rotation.apply(pivot_in_flange_m), rotation
    )
