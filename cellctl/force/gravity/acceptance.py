"""Is an identified payload good enough to guard a mating? One line a test, none hidden."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.force.gravity.payload import PayloadIdentification
from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True)
class PayloadLimits:
    """Limits of the acceptance; defaults for 200 kg below a 5 kN sensor."""

    drift_n: float = 2.0
    hold_out_n: float = 5.0
    hold_out_n_m: float = 2.0
    mass_ratio: float = 0.02
    inclination_rad: float = float(np.deg2rad(0.5))
    crosstalk_ratio: float = 0.06
    """What cross-talk of the sensor may add to mass (ratio) and inclination (rad) in a narrow cone.

    There the weight is known from small changes of the lateral force, and 1 % cross-talk between
    forces and torques at full scale moves it by 1.5 % and 1.3° (one sigma). It does no harm to
    the compensation, which hold-out poses test."""


@dataclass(frozen=True, slots=True)
class Check:
    """One test of an acceptance; ``value`` and ``limit`` in ``unit``."""

    name: str
    value: float
    limit: float
    unit: str

    @property
    def passed(self) -> bool:
        """True when the value is finite and within the limit."""
        return bool(np.isfinite(self.value) and abs(self.value) <= self.limit)

    def __str__(self) -> str:
        sign = "≤" if self.passed else ">"
        return f"{self.name} {self.value:.3g} {self.unit} {sign} {self.limit:.3g} {self.unit}"


def hold_out_checks(
    compensation: GravityCompensation,
    base_R_sensor: Rotation,
    wrenches: Array,
    limits: PayloadLimits,
) -> tuple[Check, Check]:
    """Greatest |F| and |T| that compensation leaves at poses that were not used in the fit."""
    left = compensation.apply(wrenches, base_R_sensor)
    force_n = float(np.linalg.norm(left[:, :3], axis=1).max())
    torque_n_m = float(np.linalg.norm(left[:, 3:], axis=1).max())
    return (
        Check("hold-out force", force_n, limits.hold_out_n, "N"),
        Check("hold-out torque", torque_n_m, limits.hold_out_n_m, "N·m"),
    )


def left_out_checks(
    identification: PayloadIdentification, limits: PayloadLimits
) -> tuple[Check, Check]:
    """The same from leave-one-out residuals, where no hold-out poses were recorded."""
    left = identification.affine.left_out
    force_n = float(np.linalg.norm(left[:, :3], axis=1).max())
    torque_n_m = float(np.linalg.norm(left[:, 3:], axis=1).max())
    return (
        Check("left-out force", force_n, limits.hold_out_n, "N"),
        Check("left-out torque", torque_n_m, limits.hold_out_n_m, "N·m"),
    )


def drift_check(first: Array, repeated: Array, limits: PayloadLimits) -> Check:
    """Change of force between the first pose and its repetition at the end, shape (6,) each."""
    drift_n = float(np.linalg.norm(repeated[:3] - first[:3]))
    return Check("drift of the repeated pose", drift_n, limits.drift_n, "N")


def rigid_checks(
    identification: PayloadIdentification, expected_mass_kg: float | None, limits: PayloadLimits
) -> tuple[Check, ...]:
    """Mass against CAD, where it is known, and the inclination of the base."""
    rigid = identification.rigid
    allowance = 0.0 if identification.excitation.wide else limits.crosstalk_ratio
    checks = []
    if expected_mass_kg is not None:
        error_percent = 100.0 * (rigid.mass_kg / expected_mass_kg - 1.0)
        limit_percent = 100.0 * (limits.mass_ratio + allowance)
        checks.append(Check("mass against CAD", error_percent, limit_percent, "%"))
    for name, value in (("U", rigid.inclination_u_rad), ("V", rigid.inclination_v_rad)):
        value_deg, limit_deg = np.rad2deg([value, limits.inclination_rad + allowance])
        checks.append(Check(f"inclination {name}", float(value_deg), float(limit_deg), "°"))
    return tuple(checks)
