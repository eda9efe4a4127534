"""The result of ``cellctl measure-connector`` as plain data: px, mm, mm², rad."""

from typing import Any

import numpy as np

from cellctl.geometry.pose import MM
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.vision.measurement import (
    ConnectorMeasurement,
    MeasuredContact,
)

COVARIANCE_ORDER = ("x_mm", "y_mm", "z_mm", "rx_rad", "ry_rad", "rz_rad")
_UNITS = np.array([MM, MM, MM, 1.0, 1.0, 1.0])


def result_to_json(result: ConnectorMeasurement) -> dict[str, Any]:
    """Everything that was measured; what a later command needs to check where it came from."""
    marks = result.marks
    grip = result.marks_T_connector
    return {
        "method": result.method,
        "connector": result.connector,
        "camera_id": result.camera_id,
        "contacts": [_contact(contact) for contact in result.contacts],
        "camera_T_connector": _matrix(result.camera_T_connector),
        "covariance": _covariance(result.camera_T_connector),
        "covariance_order": list(COVARIANCE_ORDER),
        "free": ["x", "y", "rz"],
        "scale": result.scale,
        "chi2": result.chi2,
        "freedom": result.freedom,
        "camera_T_marks": None if marks is None else _matrix(marks.camera_T_marks),
        "marks_covariance": None if marks is None else _covariance(marks.camera_T_marks),
        "marks_T_connector": None if grip is None else _matrix(grip),
        "warnings": list(result.warnings),
    }


def _contact(contact: MeasuredContact) -> dict[str, Any]:
    covariance, residual = contact.covariance_px2, contact.residual_m
    return {
        "name": contact.name,
        "px": contact.px.tolist(),
        "covariance_px2": None if covariance is None else covariance.tolist(),
        "residual_mm": None if residual is None else (residual / MM).tolist(),
        "state": contact.state,
    }


def _matrix(pose: UncertainPose) -> list[list[float]]:
    matrix = np.array(pose.pose.as_matrix())
    matrix[:3, 3] /= MM
    rows: list[list[float]] = matrix.tolist()
    return rows


def _covariance(pose: UncertainPose) -> list[list[float]]:
    rows: list[list[float]] = (pose.covariance / np.outer(_UNITS, _UNITS)).tolist()
    return rows
