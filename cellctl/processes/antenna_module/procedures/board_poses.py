"""Poses of the flange from which a camera and a calibration board see each other."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation
from scipy.stats import qmc

from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.settings import AntennaSettings

_DIMENSIONS = 6


def swung_poses(
    settings: AntennaSettings, base_T_flange: RigidTransform, flange_T_pivot: RigidTransform
) -> list[RigidTransform]:
    """``base_T_flange`` of all views, the present one first.

    The flange swings about the middle of the board, so that the board stays in the picture: tilted
    in all directions, turned about the line of sight, nearer and farther, and shifted so that the
    whole picture is covered. ``flange_T_pivot`` lies in the middle of the board, with x along the
    width of the picture and z along the line of sight.
    """
    base_T_pivot = base_T_flange * flange_T_pivot
    pivot_T_flange = flange_T_pivot.inv()
    # Evenly spread in all six directions at once, and the same at every calibration.
    points = 2.0 * qmc.Halton(_DIMENSIONS, scramble=True, rng=0).random(settings.views - 1) - 1.0
    return [base_T_flange] + [base_T_pivot * _swing(settings, p) * pivot_T_flange for p in points]


def _swing(settings: AntennaSettings, point: np.ndarray) -> RigidTransform:
    """``point``, shape (6,), in -1 to 1."""
    width_mm, height_mm = settings.shift_mm
    reach = (settings.tilt_deg, settings.tilt_deg, settings.turn_deg)
    tilt_x, tilt_y, turn = point[:3] * reach
    shift_mm = point[3:] * (width_mm, height_mm, settings.depth_mm)
    rotation = Rotation.from_euler("ZYX", [turn, tilt_y, tilt_x], degrees=True)
    return RigidTransform.from_components(shift_mm * MM, rotation)
