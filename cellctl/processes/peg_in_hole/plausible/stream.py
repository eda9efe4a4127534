"""Holds the limits of the arm's stream against the ways and turns of an insertion."""

from collections.abc import Iterator
from math import degrees, hypot

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.checks.places.over_places import ChainedPose, Over, flange_at
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.peg_in_hole.insertion.keyway import sweep_rad
from cellctl.processes.peg_in_hole.insertion.recovery import yaw_rad
from cellctl.processes.peg_in_hole.plan.choice import TILTED
from cellctl.processes.peg_in_hole.plan.cycle_plan import cycle_plan
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import ABOVE_HOLE, ARM
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.stations import OVER, tip_at_hole
from cellctl.processes.peg_in_hole.verdict.holding import telling_turn_rad

_TRAVEL_MM, _TRAVEL_DEG = "max_stream_travel_mm", "max_stream_travel_deg"


def over_hole(recipe: PegRecipe, key: str) -> Over:
    """The tip over the hole, where it was taught."""
    return Over(
        recipe.device(ARM),
        ABOVE_HOLE,
        pose_from_xyzabc(recipe.flange_T_tip),
        tip_at_hole(recipe),
        f"{key}.base_T_hole",
        (
            ChainedPose(
                f"{key}.base_T_hole.pose",
                recipe.base_T_hole.pose,
                after=RigidTransform.from_rotation(OVER),
            ),
        ),
        (ChainedPose(f"{key}.flange_T_tip", recipe.flange_T_tip),),
        height_mm=recipe.base_T_hole.taught_above_mm,
        is_round=recipe.fit.keys is None,
    )


def stream_issues(
    cell: CellConfig, recipe: PegRecipe, settings: PegSettings, key: str
) -> Iterator[ConfigIssue]:
    """Ways and turns that the stream would refuse in the middle of a contact.

    The driver names its limits as those of this project do; without them nothing is compared.
    """
    arm = recipe.device(ARM)
    written = cell.robots[arm].settings
    fit, place = recipe.fit, recipe.base_T_hole
    inwards_mm = fit.depth_mm + place.uncertainty_mm
    least_mm = {
        "to the seat": (inwards_mm, WrittenValue(f"{key}.fit.depth_mm", f"{fit.depth_mm:g}")),
        "to the touches of the face": (
            _to_the_face_mm(cell, recipe, arm),
            WrittenValue(f"{key}.base_T_hole.face_radius_mm", f"{place.face_radius_mm:g}"),
        ),
    }
    travel_mm = written.get(_TRAVEL_MM)
    for what, (way_mm, against) in least_mm.items():
        if isinstance(travel_mm, int | float) and travel_mm < way_mm:
            allowed = (
                f"at least {way_mm:.0f}, the way of the stream {what}; it would end in contact"
            )
            where = f"robots.{arm}.settings.{_TRAVEL_MM}"
            yield ConfigIssue(where, f"{travel_mm:g}", allowed, against=(against,))
            break
    turn_deg = _turn_deg(recipe, settings)
    travel_deg = written.get(_TRAVEL_DEG)
    if isinstance(travel_deg, int | float) and travel_deg < turn_deg:
        allowed = f"at least {turn_deg:.1f}, by which the cycle tilts and turns the part"
        yield ConfigIssue(f"robots.{arm}.settings.{_TRAVEL_DEG}", f"{travel_deg:g}", allowed)


def _to_the_face_mm(cell: CellConfig, recipe: PegRecipe, arm: str) -> float:
    place = recipe.base_T_hole
    base_T_flange = flange_at(cell, arm, ABOVE_HOLE)
    if base_T_flange is None:
        return place.face_radius_mm
    tip = tip_at_hole(recipe).inv() * base_T_flange * pose_from_xyzabc(recipe.flange_T_tip)
    height_mm = -float(tip.translation[2]) / MM
    return hypot(place.face_radius_mm, max(height_mm, 0.0) + place.datum_depth_mm)


def _turn_deg(recipe: PegRecipe, settings: PegSettings) -> float:
    """The greatest turn away from the attitude in which the stream begins."""
    plan = cycle_plan(recipe, settings)
    choice, fit = plan.choice, plan.task.fit
    tilts = bool(TILTED & set(choice.order))
    tilt_rad = choice.parameters.tilt.value if tilts else 0.0
    # Upright by then. Keys may drop at the end of the sweep, and what turns after that turns from
    # there.
    about_rad = yaw_rad(fit)
    if fit.keys is not None:
        about_rad = sweep_rad(fit.keys) + max(about_rad, telling_turn_rad(fit.keys))
    return degrees(max(tilt_rad, about_rad))
