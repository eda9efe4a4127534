"""Thresholds, tolerances and limits of a recipe against each other."""

from collections.abc import Iterator
from dataclasses import replace

from cellctl.config.checks.bounds.bound import Bound
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.checks.reach import BESIDE_MM, TURNED_DEG
from cellctl.processes.deck_to_frame.recipe import DeckRecipe

_MOST_OVER_THRESHOLD = 10.0
"""A verdict that is wider than this multiple of what the correction reaches judges nothing."""
_MOST_OVER_STAND_OFF = 2.0


def limit_bounds(recipe: DeckRecipe, key: str) -> Iterator[Bound]:
    """Each figure that has to fit the other figures of the recipe, beyond its own range."""
    bounds = (*_verdicts(recipe), *_correction(recipe), *_forces(recipe))
    yield from (replace(one, key=f"{key}.{one.key}") for one in bounds)


def _verdicts(recipe: DeckRecipe) -> Iterator[Bound]:
    correction = recipe.pose_correction
    most_mm = _MOST_OVER_THRESHOLD * correction.threshold_mm
    most_deg = _MOST_OVER_THRESHOLD * correction.threshold_deg
    of_mm = f"{_MOST_OVER_THRESHOLD:g} times threshold_mm, to which the deck is brought"
    of_deg = f"{_MOST_OVER_THRESHOLD:g} times threshold_deg, to which the deck is turned"
    yield Bound("seated_limit_mm", recipe.seated_limit_mm, of_mm, most=most_mm)
    yield Bound("seated_gap_limit_mm", recipe.seated_gap_limit_mm, of_mm, most=most_mm)
    yield Bound("seated_limit_deg", recipe.seated_limit_deg, of_deg, most=most_deg)
    if recipe.seated_limit_about_x_deg is not None:
        most_about_x_deg = _MOST_OVER_THRESHOLD * correction.thresholds_deg[0]
        of_about_x = f"{_MOST_OVER_THRESHOLD:g} times the threshold about x"
        about_x_deg = recipe.seated_limit_about_x_deg
        yield Bound("seated_limit_about_x_deg", about_x_deg, of_about_x, most=most_about_x_deg)
    most_travel_mm = _MOST_OVER_STAND_OFF * recipe.stand_off_mm
    of_travel = (
        f"{_MOST_OVER_STAND_OFF:g} times stand_off_mm: the hard end of travel, if no stop is obeyed"
    )
    yield Bound("over_travel_mm", recipe.over_travel_mm, of_travel, most=most_travel_mm)
    view = "beyond which the heads do not see all holes"
    yield Bound("station_tolerance_mm", recipe.station_tolerance_mm, view, most=BESIDE_MM / 2.0)
    yield Bound("station_tolerance_deg", recipe.station_tolerance_deg, view, most=TURNED_DEG)


def _correction(recipe: DeckRecipe) -> Iterator[Bound]:
    correction = recipe.pose_correction
    for unit in ("mm", "deg"):
        threshold = float(getattr(correction, f"threshold_{unit}"))
        name = f"max_correction_{unit}"
        value = float(getattr(correction, name))
        why = f"threshold_{unit}: what may be left needs no correction"
        yield Bound(f"pose_correction.{name}", value, why, least=threshold)
    frames, most = correction.frames, correction.max_frames
    yield Bound(
        "pose_correction.frames", frames, "max_frames, after which it is given up", most=most
    )


def _forces(recipe: DeckRecipe) -> Iterator[Bound]:
    mating = recipe.mating
    target_n, limit_n = mating.target_force_n, mating.limit_force_n
    yield Bound("mating.touch_force_n", mating.touch_force_n, "target_force_n", most=target_n)
    yield Bound(
        "mating.max_lateral_force_n", mating.max_lateral_force_n, "limit_force_n", most=limit_n
    )
    # The whole force at one end of the face, seen from the other one.
    lever_n_m = limit_n * max(recipe.face_mm) * MM
    why = "limit_force_n over the length of the face"
    yield Bound("mating.max_moment_n_m", mating.max_moment_n_m, why, most=lever_n_m)
