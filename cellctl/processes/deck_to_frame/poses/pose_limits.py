"""Refuses measurements and targets that are too far from what the recipe says."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.robot import TargetOutOfBounds
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.faults import PartMisplaced
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.vision.features.feature_file import FeatureFile

LEAST_CLEARANCE = 0.5
"""No correction may bring a corner of the deck nearer to the frame, in parts of the stand-off."""


def is_near(recipe: DeckRecipe, nominal: RigidTransform, measured: RigidTransform) -> bool:
    """True when a pose is as near to nominal as the recipe demands."""
    distance_mm, angle_deg = _apart(nominal, measured)
    return distance_mm <= recipe.station_tolerance_mm and angle_deg <= recipe.station_tolerance_deg


def require_near(
    what: str, recipe: DeckRecipe, nominal: RigidTransform, measured: RigidTransform
) -> None:
    """Raise ``PartMisplaced`` when a pose is farther from nominal than the recipe allows."""
    if not is_near(recipe, nominal, measured):
        distance_mm, angle_deg = _apart(nominal, measured)
        raise PartMisplaced(
            f"{what} is {distance_mm:.2f} mm and {angle_deg:.3f}° from nominal, allowed "
            f"{recipe.station_tolerance_mm:g} mm and {recipe.station_tolerance_deg:g}°"
        )


def require_clearance(recipe: DeckRecipe, features: FeatureFile, M_T_D: RigidTransform) -> None:
    """Raise ``TargetOutOfBounds`` when a commanded deck would come too near to the frame.

    The guard watches the corrections too, but it stops an arm only after it has met something: they
    must not be able to touch, however wrong the measurement behind them is.
    """
    holes_m = np.array([hole.position_m for hole in features.holes])
    half_x_m, half_y_m = np.abs(holes_m[:, :2]).max(axis=0)
    under_m = -recipe.deck_thickness_mm * MM
    corners_m = [[x, y, under_m] for x in (-half_x_m, half_x_m) for y in (-half_y_m, half_y_m)]
    clearance_m = float(M_T_D.apply(corners_m)[:, 2].min())
    least_m = LEAST_CLEARANCE * recipe.stand_off_mm * MM
    # Written so that a clearance that is not a number is refused.
    if not clearance_m >= least_m:
        raise TargetOutOfBounds(
            f"deck {clearance_m / MM:.2f} mm above the frame, at least {least_m / MM:.2f} mm "
            "before mating"
        )


def _apart(nominal: RigidTransform, measured: RigidTransform) -> tuple[float, float]:
    delta = nominal.inv() * measured
    distance_mm = float(np.linalg.norm(delta.translation)) / MM
    return distance_mm, float(np.degrees(delta.rotation.magnitude()))
