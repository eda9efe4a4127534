"""What the thresholds of a recipe leave at the pins and edges of a face of its size."""

from collections.abc import Iterator
from math import degrees, hypot, radians

from cellctl.config.issue import ConfigIssue
from cellctl.force.contact.seat import SEAT_DEPTH_M
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.vision.features.feature_file import FeatureFile


def face_issues(recipe: DeckRecipe, key: str, deck: FeatureFile) -> Iterator[ConfigIssue]:
    """Angles and moments that fit a smaller face than this one; ``deck`` is its drawing."""
    yield from _pins(recipe, key, deck)
    yield from _edges(recipe, key)
    yield from _corner(recipe, key)


def _pins(recipe: DeckRecipe, key: str, deck: FeatureFile) -> Iterator[ConfigIssue]:
    """A deck within its thresholds is mated, and its pins must then be within their limit."""
    correction = recipe.pose_correction
    pins = [hole for hole in deck.holes if hole.kind == "pin"] or deck.holes
    farthest = max(pins, key=lambda hole: hypot(*hole.position_m[:2]))
    lever_mm = hypot(*farthest.position_m[:2]) / MM
    shifted_mm = hypot(correction.threshold_mm, correction.threshold_mm)
    spare_mm = recipe.seated_limit_mm - shifted_mm
    about_z_deg = correction.thresholds_deg[2]
    turned_mm = radians(about_z_deg) * lever_mm
    if turned_mm <= spare_mm:
        return
    name = "threshold_deg" if correction.threshold_about_z_deg is None else "threshold_about_z_deg"
    if spare_mm <= 0.0:
        allowed = (
            f"less than {recipe.seated_limit_mm / hypot(1.0, 1.0):.3g}: along x and y together it "
            f"leaves {shifted_mm:.3f} mm, and seated_limit_mm is {recipe.seated_limit_mm:g}"
        )
        yield ConfigIssue(
            f"{key}.pose_correction.threshold_mm", f"{correction.threshold_mm:g}", allowed
        )
        return
    allowed = (
        f"at most {degrees(spare_mm / lever_mm):.2g} about z (threshold_about_z_deg): "
        f"{farthest.name} is {lever_mm:.0f} mm from the middle, where this leaves "
        f"{turned_mm:.3f} mm beside the {shifted_mm:.3f} mm of threshold_mm, and seated_limit_mm "
        f"is {recipe.seated_limit_mm:g}"
    )
    yield ConfigIssue(f"{key}.pose_correction.{name}", f"{about_z_deg:g}", allowed)


def _edges(recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """A tilted deck lands on an edge, and its middle must not seem to stand above its seat."""
    about_x_deg, about_y_deg, _ = recipe.pose_correction.thresholds_deg
    length_mm, width_mm = recipe.face_mm
    along_y_mm = radians(about_x_deg) * width_mm / 2
    along_x_mm = radians(about_y_deg) * length_mm / 2
    lifted_mm, most_mm = hypot(along_x_mm, along_y_mm), SEAT_DEPTH_M / MM
    if lifted_mm <= most_mm:
        return
    worse = along_y_mm > along_x_mm and recipe.pose_correction.threshold_about_x_deg is not None
    name = "threshold_about_x_deg" if worse else "threshold_deg"
    value = about_x_deg if worse else about_y_deg
    allowed = (
        f"at most {value * most_mm / lifted_mm:.2g}, and the other angle by the same share: on a "
        f"face of {length_mm:g} x {width_mm:g} mm they leave an edge {lifted_mm:.3f} mm lower than "
        f"the middle, and a deck {most_mm:g} mm above its seat is not seated (F524). If the heads "
        "cannot tell so little (F432), the holes that they see must lie farther apart"
    )
    yield ConfigIssue(f"{key}.pose_correction.{name}", f"{value:g}", allowed)


def _corner(recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """The first touch may be that of a corner."""
    mating = recipe.mating
    lever_m = hypot(*recipe.face_mm) / 2 * MM
    least_n_m = mating.target_force_n * lever_m
    if mating.max_moment_n_m < least_n_m:
        allowed = (
            f"at least {least_n_m:.0f}: target_force_n on a corner of the face, {lever_m:.2f} m "
            "from its middle"
        )
        yield ConfigIssue(f"{key}.mating.max_moment_n_m", f"{mating.max_moment_n_m:g}", allowed)
