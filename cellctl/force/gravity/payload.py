"""Payload identification from still poses: rigid12 for the log, affine24 for the compensation.

Paper 2.4.1. ``rigid12`` is the model of the literature: the weight ``w`` is constant in the base,
and a reading is ``f = Rᵀ w + f0`` and ``τ = c × (Rᵀ w) + τ0``. Its mass and centre of mass can be
compared with CAD. ``affine24`` has no such meaning but leaves smaller residuals on a real sensor,
whose cross-talk of 1 % is 20 N below 200 kg; so it is what the guard uses.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.force.gravity.excitation import Excitation, require_excitation
from cellctl.force.gravity.gravity_compensation import (
    BASE_DOWN,
    GRAVITY_M_S2,
    GravityCompensation,
    gravity_in_sensor,
)
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import skew


@dataclass(frozen=True, slots=True, eq=False)
class Rigid12:
    """A rigid load on an ideal sensor: what an operator can compare with CAD."""

    mass_kg: float
    centre_of_mass_m: Array
    """Shape (3,), in the sensor frame."""
    force_offset_n: Array
    torque_offset_n_m: Array
    weight_n: Array
    """Shape (3,): w in base axes."""
    inclination_u_rad: float
    """Tilt of the base, U = asin(−L_y/|L|) with L = −w (黄玲涛 2020)."""
    inclination_v_rad: float
    """V = atan2(L_x, L_z). The yaw of the base about gravity cannot be observed."""
    reads_reaction: bool
    """True when the weight points up: this sensor states the reaction, not the load."""
    residual: Array
    """Shape (n, 6), N and N·m."""

    @property
    def base_down(self) -> tuple[float, float, float]:
        """Unit vector of gravity in the base, as identified."""
        down = self.weight_n / np.linalg.norm(self.weight_n)
        x, y, z = map(float, -down if self.reads_reaction else down)
        return x, y, z


@dataclass(frozen=True, slots=True, eq=False)
class Affine24:
    """The affine model with its residuals."""

    compensation: GravityCompensation
    residual: Array
    """Shape (n, 6), N and N·m."""
    left_out: Array
    """Shape (n, 6): residual of each pose when predicted from all the others."""


@dataclass(frozen=True, slots=True)
class PayloadIdentification:
    """Both models of one record, and how well its poses determine them."""

    rigid: Rigid12
    affine: Affine24
    excitation: Excitation
    poses: int


def identify_payload(
    base_R_sensor: Rotation, wrenches: Array, gravity_m_s2: float = GRAVITY_M_S2
) -> PayloadIdentification:
    """Fit rigid12 and affine24 to n still poses; wrenches in sensor axes, shape (n, 6).

    Within a narrow cone the affine form absorbs a base that is not quite level. Over a wide range
    of poses it cannot, but there rigid12 determines the direction of gravity well, so it is taken
    from there. Raises ``TooFewPoses`` or ``PosesDegenerate`` with the reason.
    """
    found = require_excitation(base_R_sensor, "affine24")
    rigid = fit_rigid12(base_R_sensor, wrenches, gravity_m_s2)
    # In a narrow cone the direction that rigid12 finds is mostly cross-talk, so the base counts as
    # level there.
    down = rigid.base_down if found.wide else BASE_DOWN
    affine = fit_affine24(base_R_sensor, wrenches, down)
    return PayloadIdentification(rigid, affine, found, len(wrenches))


def fit_rigid12(
    base_R_sensor: Rotation, wrenches: Array, gravity_m_s2: float = GRAVITY_M_S2
) -> Rigid12:
    """Linear fit of mass, centre of mass, offsets and the direction of gravity in the base.

    The torque is regressed on the *modelled* force. The measured one carries noise, and noise in a
    regressor would bias the centre of mass towards zero.
    """
    require_excitation(base_R_sensor, "rigid12")
    sensor_R_base = base_R_sensor.inv().as_matrix()
    count = len(wrenches)
    eye = np.broadcast_to(np.eye(3), (count, 3, 3))
    design = np.concatenate([eye, sensor_R_base], axis=2).reshape(-1, 6)
    solution, *_ = np.linalg.lstsq(design, wrenches[:, :3].ravel())
    force_offset, weight = solution[:3], solution[3:]

    # The second half of rigid12: τ = c × f + τ0 is linear in c once the force is known.
    load = sensor_R_base @ weight
    arms = np.stack([-skew(force) for force in load])
    design = np.concatenate([eye, arms], axis=2).reshape(-1, 6)
    solution, *_ = np.linalg.lstsq(design, wrenches[:, 3:].ravel())
    torque_offset, centre = solution[:3], solution[3:]

    modelled = np.hstack([load + force_offset, np.cross(centre, load) + torque_offset])
    size = float(np.linalg.norm(weight))
    # Some sensors state what the load does to them, others what they do to the load. The sign of
    # the weight tells which, and the compensation works with either.
    reads_reaction = bool(weight[2] > 0.0)
    up = weight / size if reads_reaction else -weight / size
    return Rigid12(
        mass_kg=size / gravity_m_s2,
        centre_of_mass_m=centre,
        force_offset_n=force_offset,
        torque_offset_n_m=torque_offset,
        weight_n=weight,
        inclination_u_rad=float(np.arcsin(-up[1])),
        inclination_v_rad=float(np.arctan2(up[0], up[2])),
        reads_reaction=reads_reaction,
        residual=wrenches - modelled,
    )


def fit_affine24(
    base_R_sensor: Rotation,
    wrenches: Array,
    base_down: tuple[float, float, float] = BASE_DOWN,
) -> Affine24:
    """Linear fit of ``y = A u + b`` with u the unit vector of gravity in sensor axes."""
    require_excitation(base_R_sensor, "affine24")
    design = np.column_stack([gravity_in_sensor(base_R_sensor, base_down), np.ones(len(wrenches))])
    solution, *_ = np.linalg.lstsq(design, wrenches)
    residual = wrenches - design @ solution
    force_rms, torque_rms = rms_residuals(residual)
    model = GravityCompensation(
        np.ascontiguousarray(solution[:3].T),
        solution[3],
        "affine24",
        force_rms,
        torque_rms,
        base_down,
    )
    # The leave-one-out residual of a linear fit is r / (1 − h), with h the leverage of the row: no
    # need to fit n times.
    leverage = np.einsum("ij,ji->i", design, np.linalg.pinv(design))
    # A pose that alone determines a direction has leverage one: its left-out residual is unknown,
    # here very large, and not a division by zero.
    free = np.clip(1.0 - leverage, 1e-6, None)
    return Affine24(model, residual, residual / free[:, None])


def rms_residuals(residual: Array) -> tuple[float, float]:
    """Root mean square over poses and components: of the forces (N), of the torques (N·m)."""
    force, torque = residual[:, :3], residual[:, 3:]
    return float(np.sqrt(np.mean(force**2))), float(np.sqrt(np.mean(torque**2)))
