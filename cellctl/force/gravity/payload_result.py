"""From a record of poses to an accepted payload: the one function behind procedure and command."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from cellctl.errors.calibration import CalibrationRecordInvalid
from cellctl.force.gravity.acceptance import (
    PayloadCheck,
    PayloadLimits,
    drift_check,
    residual_checks,
    rigid_checks,
)
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.force.gravity.payload import PayloadIdentification, identify_payload, rms_residuals
from cellctl.force.gravity.pose_file import PoseRecord
from cellctl.force.gravity.poses import PoseRole
from cellctl.force.gravity.signs import reversed_axis_check, torque_axes_check
from cellctl.geometry.pose import MM


@dataclass(frozen=True, slots=True)
class PayloadResult:
    """An identification with its acceptance tests."""

    identification: PayloadIdentification
    checks: tuple[PayloadCheck, ...]

    @property
    def compensation(self) -> GravityCompensation:
        """The gravity compensation that the guard subtracts from its readings."""
        return self.identification.affine.compensation

    @property
    def accepted(self) -> bool:
        """True when every test was passed."""
        return all(check.passed for check in self.checks)

    def also(self, checks: tuple[PayloadCheck, ...]) -> "PayloadResult":
        """This result with further tests that it has to pass."""
        return replace(self, checks=(*self.checks, *checks))


def evaluate_payload(
    record: PoseRecord,
    *,
    expected_mass_kg: float | None = None,
    limits: PayloadLimits | None = None,
) -> PayloadResult:
    """Identify the payload from the ``fit`` poses and test it on the others.

    Without ``hold-out`` poses each pose is predicted from all the others instead. A ``repeat``
    pose is compared with the first. Raises ``TooFewPoses`` or ``PosesDegenerate``.
    """
    limits = limits or PayloadLimits()
    fit = record.having(PoseRole.FIT)
    identification = identify_payload(fit.base_R_sensor, fit.wrenches)
    checks = list(rigid_checks(identification, expected_mass_kg, limits))
    checks.append(reversed_axis_check(identification.rigid, fit.base_R_sensor))
    checks.append(torque_axes_check(identification.rigid, fit.wrenches))
    affine = identification.affine
    hold_out = record.having(PoseRole.HOLD_OUT)
    if hold_out.roles:
        # The affine model is the one that is used afterwards, so it is the one that is tested.
        left = affine.compensation.apply(hold_out.wrenches, hold_out.base_R_sensor)
        checks += residual_checks("hold-out", left, limits)
    else:
        checks += residual_checks("left-out", affine.left_out, limits)
    repeat = record.having(PoseRole.REPEAT)
    if repeat.roles:
        checks.append(drift_check(fit.wrenches[0], repeat.wrenches[-1], limits))
    return PayloadResult(identification, tuple(checks))


def payload_document(result: PayloadResult) -> dict[str, Any]:
    """Plain data of a result for files and the store; lengths in mm, angles in degrees."""
    rigid, affine = result.identification.rigid, result.identification.affine
    excitation = result.identification.excitation
    force_rms, torque_rms = rms_residuals(rigid.residual)
    return {
        "accepted": result.accepted,
        "poses": result.identification.poses,
        "rigid12": {
            "mass_kg": rigid.mass_kg,
            "centre_of_mass_mm": (rigid.centre_of_mass_m / MM).tolist(),
            "force_offset_n": rigid.force_offset_n.tolist(),
            "torque_offset_nm": rigid.torque_offset_n_m.tolist(),
            "weight_in_base_n": rigid.weight_n.tolist(),
            "inclination_u_deg": float(np.rad2deg(rigid.inclination_u_rad)),
            "inclination_v_deg": float(np.rad2deg(rigid.inclination_v_rad)),
            "reads_reaction": rigid.reads_reaction,
            "residual_rms_n": force_rms,
            "residual_rms_nm": torque_rms,
            "residuals": rigid.residual.tolist(),
        },
        "affine24": {
            "matrix": affine.compensation.A.tolist(),
            "offset": affine.compensation.b.tolist(),
            "gravity_direction_in_base": list(affine.compensation.base_down),
            "residual_rms_n": affine.compensation.residual_n,
            "residual_rms_nm": affine.compensation.residual_n_m,
            "residuals": affine.residual.tolist(),
            "left_out_residuals": affine.left_out.tolist(),
        },
        "excitation": {
            "distinct_directions": excitation.distinct,
            "tilt_rms_deg": np.rad2deg(excitation.tilt_rad).tolist(),
            "condition_rigid12": excitation.condition_rigid12,
            "condition_affine24": excitation.condition_affine24,
        },
        "checks": [
            {**asdict(check), "side": "both", "passed": check.passed} for check in result.checks
        ],
    }


def gravity_compensation_from_document(document: dict[str, Any]) -> GravityCompensation:
    """The gravity compensation of a document that ``payload_document`` made.

    Raises ``KeyError``, ``TypeError`` or ``ValueError`` when it holds none.
    """
    affine = document["affine24"]
    x, y, z = (float(value) for value in affine["gravity_direction_in_base"])
    return GravityCompensation(
        np.asarray(affine["matrix"], dtype=float),
        np.asarray(affine["offset"], dtype=float),
        "affine24",
        float(affine["residual_rms_n"]),
        float(affine["residual_rms_nm"]),
        (x, y, z),
    )


def mass_kg(document: Mapping[str, Any]) -> float:
    """Mass on the sensor in a document; raises ``CalibrationRecordInvalid`` when it has none."""
    try:
        return float(document["rigid12"]["mass_kg"])
    except (KeyError, TypeError, ValueError) as error:
        raise CalibrationRecordInvalid(f"payload: no mass, {error!r}") from error
