"""A calibrated stereo head and its JSON file.

The head frame is the left camera: x right, y down, z forward. Pixel centres lie at integers.
"""

import json
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.vision import CalibrationFileInvalid
from cellctl.geometry.pose import MM, Array
from cellctl.sealed_json import record_within

DISTORTION_TERMS = (5, 8, 12, 14)
"""Lengths of the distortion: OpenCV's models, of which each contains the shorter ones."""
CAMERA_PARAMETERS = (
    *("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"),
    *("k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"),
)
"""Numbers of a camera; one with five terms of distortion has the first nine."""
_ROTATION_TOLERANCE = 1e-6
"""Largest element of R Rᵀ − I. OpenCV writes rotations to 1e-15; a matrix that was typed to five
digits is off by more."""


@dataclass(frozen=True, slots=True, eq=False)
class CameraModel:
    """One camera: pinhole with OpenCV's distortion."""

    camera_matrix: Array
    """Shape (3, 3), px."""
    distortion: Array
    """Shape (5,), (8,), (12,) or (14,): k1, k2, p1, p2, k3, k4 to k6, s1 to s4, and the two angles
    of a tilted sensor (rad)."""


@dataclass(frozen=True, slots=True, eq=False)
class StereoHead:
    """Two cameras that expose together; ``x_right = rotation @ x_left + translation_m``."""

    image_size: tuple[int, int]
    """Width, height in px."""
    left: CameraModel
    right: CameraModel
    rotation: Array
    """Shape (3, 3)."""
    translation_m: Array
    """Shape (3,)."""
    rms_px: float
    covariance: Array | None = None
    """Covariance of the numbers in ``parameter_order``, shape (24, 24) with five terms of
    distortion each; None when it is not known. Units are px, plain numbers, rad and m (mm in the
    file). The rotation is perturbed as R = Exp(dr) R0."""

    @property
    def parameter_order(self) -> tuple[str, ...]:
        """Names of the numbers of a head: those of both cameras, rotation, translation."""
        return (
            *(f"left.{name}" for name in CAMERA_PARAMETERS[: 4 + len(self.left.distortion)]),
            *(f"right.{name}" for name in CAMERA_PARAMETERS[: 4 + len(self.right.distortion)]),
            *("rotation.x", "rotation.y", "rotation.z"),
            *("translation.x", "translation.y", "translation.z"),
        )

    @property
    def right_T_left(self) -> RigidTransform:
        """Pose of the left camera in the right camera."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.rotation
        matrix[:3, 3] = self.translation_m
        return RigidTransform.from_matrix(matrix)


def read_stereo_head(path: Path) -> StereoHead:
    """Read a calibration, of a command or stored; ``CalibrationFileInvalid`` says why not.

    Warns when the file says that the calibration did not pass its checks.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise CalibrationFileInvalid(f"{path}: {error.strerror or error}") from error
    except ValueError as error:
        raise CalibrationFileInvalid(f"{path} is not JSON: {error}") from error
    try:
        data = record_within(data)
        head = stereo_head_from_json(data)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        reason = f"missing {error}" if isinstance(error, KeyError) else str(error)
        raise CalibrationFileInvalid(f"{path}: {reason}") from error
    if data.get("verdict") == "fail":
        warnings.warn(
            f"{path}: this calibration did not pass its checks; what it measures may be wrong",
            stacklevel=2,
        )
    return head


def stereo_head_to_json(head: StereoHead) -> dict[str, Any]:
    """The head as the plain data of its file: lengths in mm."""
    data: dict[str, Any] = {
        "image_size": list(head.image_size),
        "left": camera_to_json(head.left),
        "right": camera_to_json(head.right),
        "rotation": head.rotation.tolist(),
        "translation_mm": (head.translation_m / MM).tolist(),
        "rms_px": head.rms_px,
        "covariance": None,
        "covariance_order": list(head.parameter_order),
    }
    if head.covariance is not None:
        data["covariance"] = (head.covariance / _file_scale(head)).tolist()
    return data


def camera_to_json(camera: CameraModel) -> dict[str, Any]:
    """One camera as plain data."""
    return {
        "camera_matrix": camera.camera_matrix.tolist(),
        "distortion": camera.distortion.tolist(),
    }


def stereo_head_from_json(data: Mapping[str, Any]) -> StereoHead:
    """The inverse of ``stereo_head_to_json``.

    Raises ``KeyError``, ``TypeError`` or ``ValueError``.
    """
    width, height = (int(value) for value in data["image_size"])
    if width <= 0 or height <= 0:
        raise ValueError("image_size must be two positive numbers")
    rotation = _array(data, "rotation", (3, 3))
    # Files that were typed or rounded to a few digits would bend every ray a little, unnoticed.
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > _ROTATION_TOLERANCE:
        raise ValueError("rotation is not a rotation matrix")
    # A reflection passes the test of orthogonality; exchanged axes in a file produce one.
    if np.linalg.det(rotation) < 0:
        raise ValueError("rotation is a reflection")
    translation_m = _array(data, "translation_mm", (3,)) * MM
    if not np.linalg.norm(translation_m) > 0:
        raise ValueError("translation_mm is zero: the cameras have no baseline")
    head = StereoHead(
        image_size=(width, height),
        left=_side_from_json(data, "left"),
        right=_side_from_json(data, "right"),
        rotation=rotation,
        translation_m=translation_m,
        rms_px=float(data.get("rms_px", np.nan)),
    )
    return replace(head, covariance=_covariance_from_json(data, head))


def _file_scale(head: StereoHead) -> Array:
    """Files have the translation in mm."""
    units = np.ones(len(head.parameter_order))
    units[-3:] = MM
    return np.outer(units, units)


def _covariance_from_json(data: Mapping[str, Any], head: StereoHead) -> Array | None:
    """The covariance of a file; None without one.

    A covariance in another order than ours, from another program, cannot be assigned to the numbers
    of the head: it is left out, with a warning.
    """
    if data.get("covariance") is None:
        return None
    if data.get("covariance_order") != list(head.parameter_order):
        warnings.warn(
            "covariance of the calibration left out: covariance_order is not ours", stacklevel=2
        )
        return None
    count = len(head.parameter_order)
    return _array(data, "covariance", (count, count)) * _file_scale(head)


def _side_from_json(data: Mapping[str, Any], side: str) -> CameraModel:
    try:
        return camera_from_json(data[side])
    except KeyError as error:
        raise ValueError(f"{side}: missing {error}") from error
    except ValueError as error:
        raise ValueError(f"{side}: {error}") from error


def camera_from_json(data: Mapping[str, Any]) -> CameraModel:
    """The inverse of ``camera_to_json``; raises ``KeyError``, ``TypeError`` or ``ValueError``."""
    matrix = _array(data, "camera_matrix", (3, 3))
    terms = np.size(data["distortion"])
    distortion = _array(data, "distortion", (terms if terms in DISTORTION_TERMS else 5,))
    if matrix[0, 0] <= 0 or matrix[1, 1] <= 0 or not np.array_equal(matrix[2], [0.0, 0.0, 1.0]):
        raise ValueError("camera_matrix must be [[fx,0,cx],[0,fy,cy],[0,0,1]] with positive fx, fy")
    return CameraModel(matrix, distortion)


def _array(data: Mapping[str, Any], key: str, shape: tuple[int, ...]) -> Array:
    """Numbers of one shape; a vector may be a row or a column, as OpenCV writes it."""
    values = np.asarray(data[key], dtype=float)
    if values.squeeze().shape != shape or not np.isfinite(values).all():
        raise ValueError(f"{key} must hold finite numbers of shape {shape}")
    return values.reshape(shape)
