"""Judges whether a set of poses moves gravity enough in the sensor to identify a payload.

A least-squares fit also returns numbers when the poses cannot tell the load, and they may look
plausible. So such poses are refused before the fit, with what to change.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.errors.force import PosesDegenerate, TooFewPoses
from cellctl.force.gravity.gravity_compensation import gravity_in_sensor
from cellctl.geometry.pose import Array

MIN_POSES = {"rigid12": 4, "affine24": 6}
"""Distinct directions of gravity that each model needs. A channel of affine24 has four unknowns;
two poses more leave residuals to judge the fit by."""

MIN_TILT_RAD = np.deg2rad(3.0)
"""Root-mean-square tilt of gravity below which a direction counts as not excited. The planned cone
of 12° has about twice that in both directions (``poses``)."""

WIDE_TILT_RAD = np.deg2rad(20.0)
"""Root-mean-square tilt above which the direction of gravity can be told from cross-talk."""

SAME_DIRECTION_RAD = np.deg2rad(0.5)
"""Poses whose gravity directions differ by less count once: a pose that was recorded twice must not
pass for two."""


@dataclass(frozen=True, slots=True, eq=False)
class Excitation:
    """The range over which gravity moves in sensor axes over a set of poses."""

    distinct: int
    """Number of clearly different directions of gravity."""
    tilt_rad: Array
    """Shape (3,): rms spread of gravity's direction along its principal axes, greatest first."""
    axes: Array
    """Shape (3, 3): these axes in sensor coordinates, one in each row."""
    condition_rigid12: float
    """Condition number of the force equation of rigid12."""
    condition_affine24: float

    @property
    def wide(self) -> bool:
        """True when the poses differ so much that they determine the direction of gravity well."""
        return bool(self.tilt_rad[1] > WIDE_TILT_RAD)


def excitation(base_R_sensor: Rotation) -> Excitation:
    """Measure the excitation of n orientations (a stacked ``Rotation``)."""
    down = np.atleast_2d(gravity_in_sensor(base_R_sensor))
    _, spread, axes = np.linalg.svd(down - down.mean(axis=0), full_matrices=True)
    tilt = np.zeros(3)
    tilt[: len(spread)] = spread / np.sqrt(len(down))
    eye = np.broadcast_to(np.eye(3), (len(down), 3, 3))
    matrices = np.atleast_3d(base_R_sensor.inv().as_matrix()).reshape(-1, 3, 3)
    rigid = np.concatenate([eye, matrices], axis=2).reshape(-1, 6)
    affine = np.column_stack([down, np.ones(len(down))])
    return Excitation(distinct_directions(down), tilt, axes, _condition(rigid), _condition(affine))


def distinct_directions(directions: Array) -> int:
    """Number of unit vectors, shape (n, 3), that differ by more than ``SAME_DIRECTION_RAD``."""
    kept: list[Array] = []
    for direction in directions:
        if all(np.linalg.norm(direction - other) > SAME_DIRECTION_RAD for other in kept):
            kept.append(direction)
    return len(kept)


def require_excitation(base_R_sensor: Rotation, method: str) -> Excitation:
    """``excitation``, refused with the reason when ``method`` could not be solved from it.

    Raises ``TooFewPoses`` or ``PosesDegenerate``.
    """
    found = excitation(base_R_sensor)
    needed = MIN_POSES[method]
    # There are poses enough, so "too few" would send the operator to record more of the same.
    if found.distinct == 1 and len(base_R_sensor) >= needed:
        raise PosesDegenerate(
            f"{len(base_R_sensor)} poses but gravity points the same way in the sensor in all of "
            "them: turning about the vertical tells nothing, tilt about horizontal axes"
        )
    if found.distinct < needed:
        raise TooFewPoses(
            f"{found.distinct} distinct directions of gravity, {method} needs {needed}"
        )
    # The second direction decides. Tilts about one axis only leave the fit free across it; in
    # simulation that cost 65 N.
    if found.tilt_rad[1] < MIN_TILT_RAD:
        _refuse_tilt(found)
    return found


def _refuse_tilt(found: Excitation) -> None:
    first_deg, second_deg = np.rad2deg(found.tilt_rad[:2])
    least_deg = np.rad2deg(MIN_TILT_RAD)
    if found.tilt_rad[0] < MIN_TILT_RAD:
        raise PosesDegenerate(
            f"gravity moves only {first_deg:.2f}° rms in the sensor, at least {least_deg:.1f}° "
            "are needed in two directions"
        )
    weak = ", ".join(f"{value:+.2f}" for value in found.axes[1])
    raise PosesDegenerate(
        f"gravity moves {first_deg:.1f}° rms in one direction but only {second_deg:.2f}° along "
        f"sensor direction ({weak}): the poses tilt about one axis only, at least "
        f"{least_deg:.1f}° are needed about two"
    )


def _condition(matrix: Array) -> float:
    values = np.linalg.svd(matrix, compute_uv=False)
    # Fewer rows than unknowns: singular, although each of the singular values is positive.
    smallest = values[-1] if len(values) == matrix.shape[1] else 0.0
    return float(values[0] / smallest) if smallest > 0.0 else float("inf")
