"""A part must be about where the recipe says before the cell believes a measurement."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.recipe import Recipe
from cellctl.errors.vision import PartMisplaced
from cellctl.geometry.pose import MM


def require_near(
    what: str, recipe: Recipe, nominal: RigidTransform, measured: RigidTransform
) -> None:
    """Raise ``PartMisplaced`` when a pose is farther from nominal than the recipe allows."""
    delta = nominal.inv() * measured
    distance_mm = float(np.linalg.norm(delta.translation)) / MM
    angle_deg = float(np.degrees(delta.rotation.magnitude()))
    if distance_mm > recipe.station_tolerance_mm or angle_deg > recipe.station_tolerance_deg:
        raise PartMisplaced(
            f"{what} is {distance_mm:.2f} mm and {angle_deg:.3f}° from nominal, allowed "
            f"{recipe.station_tolerance_mm:g} mm and {recipe.station_tolerance_deg:g}°"
        )
