"""Acceptance of an identified payload: the checks to pass before the guard relies on it."""

from dataclasses import dataclass

import numpy as np

from cellctl.force.gravity.payload import PayloadIdentification
from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True)
class PayloadLimits:
    """Limits of the acceptance; the defaults are for 200 kg below a 5 kN sensor."""

    drift_n: float = 2.0
    """Change of force from the first pose to its repetition at the end. What drifts by more in some
    minutes also drifts between the tare and the end of a mating."""
    hold_out_n: float = 5.0
    """Simulated with 200 kg and every error of sensor and arm together, the compensation leaves
    4.6 N and 1.8 N·m in 95 % of the cases."""
    hold_out_n_m: float = 2.0
    mass_ratio: float = 0.02
    """Difference from the mass in CAD; a part with a forgotten fixture differs by more."""
    inclination_rad: float = float(np.deg2rad(0.5))
    """Tilt of the robot base against the vertical, about x and about y."""
    crosstalk_ratio: float = 0.06
    """Allowance for the sensor's cross-talk in mass (ratio) and inclination (rad).

    In a narrow cone the weight follows from small changes of the lateral force, and 1 % cross-talk
    between forces and torques at full scale moves it by 1.5 % and 1.3° (one sigma). It does no harm
    to the compensation itself, which is tested on hold-out poses."""


@dataclass(frozen=True, slots=True)
class PayloadCheck:
    """One figure of an acceptance and its limit, both in ``unit``."""

    name: str
    value: float
    limit: float
    unit: str

    @property
    def passed(self) -> bool:
        """True when the magnitude of the value is finite and within the limit."""
        return bool(np.isfinite(self.value) and abs(self.value) <= self.limit)

    def __str__(self) -> str:
        sign = "≤" if self.passed else ">"
        return f"{self.name} {self.value:.3g} {self.unit} {sign} {self.limit:.3g} {self.unit}"


def residual_checks(
    name: str, left: Array, limits: PayloadLimits
) -> tuple[PayloadCheck, PayloadCheck]:
    """Greatest |F| and |T| of what the compensation leaves, shape (n, 6), N and N·m.

    ``left`` must come from poses that the fit did not use: the residuals of a fit say little about
    the next pose.
    """
    force_n = float(np.linalg.norm(left[:, :3], axis=1).max())
    torque_n_m = float(np.linalg.norm(left[:, 3:], axis=1).max())
    return (
        PayloadCheck(f"{name} force", force_n, limits.hold_out_n, "N"),
        PayloadCheck(f"{name} torque", torque_n_m, limits.hold_out_n_m, "N·m"),
    )


def drift_check(first: Array, repeated: Array, limits: PayloadLimits) -> PayloadCheck:
    """Change of force between the first pose and its repetition at the end, shape (6,) each."""
    # The same pose twice needs no model: what differs is the sensor, its temperature or a hose.
    drift_n = float(np.linalg.norm(repeated[:3] - first[:3]))
    return PayloadCheck("drift of the repeated pose", drift_n, limits.drift_n, "N")


def rigid_checks(
    identification: PayloadIdentification, expected_mass_kg: float | None, limits: PayloadLimits
) -> tuple[PayloadCheck, ...]:
    """Mass against CAD, where that is known, and the inclination of the base.

    They find what no residual shows: a wrong part on the gripper, or a robot that is not level.
    """
    rigid = identification.rigid
    # Over wide poses gravity itself moves by so much that cross-talk cannot pass for it, and the
    # limits hold as they are.
    allowance = 0.0 if identification.excitation.wide else limits.crosstalk_ratio
    checks = []
    if expected_mass_kg is not None:
        error_percent = 100.0 * (rigid.mass_kg / expected_mass_kg - 1.0)
        limit_percent = 100.0 * (limits.mass_ratio + allowance)
        checks.append(PayloadCheck("mass against CAD", error_percent, limit_percent, "%"))
    for name, value in (("U", rigid.inclination_u_rad), ("V", rigid.inclination_v_rad)):
        value_deg, limit_deg = np.rad2deg([value, limits.inclination_rad + allowance])
        checks.append(PayloadCheck(f"inclination {name}", float(value_deg), float(limit_deg), "°"))
    return tuple(checks)
