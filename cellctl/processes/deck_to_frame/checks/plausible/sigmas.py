"""Holds what a recipe claims of its parts and its arm against what is made at all.

The contact window and the creep are planned from these figures: one that is too small makes good
contacts come too early or too late, at the end of a run.
"""

from collections.abc import Iterator

from cellctl.config.checks.bounds.bound import Bound
from cellctl.processes.deck_to_frame.recipe import DeckRecipe

_IT5_UNITS = 7.0
"""Tolerance grade IT5 of ISO 286-1 in tolerance units: ground and lapped, no plate is better."""
_EVENLY_SPREAD = 12.0**0.5
"""Width of an even distribution over its standard deviation."""
_LEAST_TRAVEL_MM = 0.003
"""A straight move of 10 mm: what laser trackers resolve, and a tenth of the repeatability of arms
of this size."""
_LEAST_STEP_MM = 0.001
"""One count of a motor's encoder, behind its gear, at the end of an arm of two metres."""


def sigma_bounds(recipe: DeckRecipe, key: str) -> Iterator[Bound]:
    """Standard deviations that no part and no arm has."""
    thick_mm = recipe.deck_thickness_mm
    unit_mm = (0.45 * thick_mm ** (1 / 3) + 0.001 * thick_mm) * 1e-3
    least_mm = _IT5_UNITS * unit_mm / _EVENLY_SPREAD
    why = (
        f"tolerance grade IT5 of {thick_mm:g} mm over the root of twelve; with less the contact "
        "window is so narrow that good decks touch outside of it"
    )
    sigma_mm = recipe.deck_thickness_sigma_mm
    yield Bound(f"{key}.deck_thickness_sigma_mm", sigma_mm, why, least=least_mm)
    mating = recipe.mating
    why = "no arm that carries a deck goes 10 mm straight to less; the contact window rests on it"
    yield Bound(
        f"{key}.mating.travel_sigma_mm", mating.travel_sigma_mm, why, least=_LEAST_TRAVEL_MM
    )
    why = "a count of the encoders at the flange is about so much; the creep rests on it"
    yield Bound(f"{key}.mating.step_sigma_mm", mating.step_sigma_mm, why, least=_LEAST_STEP_MM)
