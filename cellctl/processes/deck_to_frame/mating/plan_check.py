"""Would the recipes' figures give a mating plan? Asked before anything moves."""

from collections.abc import Iterator

from scipy.spatial.transform import RigidTransform

from cellctl.config import CellConfig, Problem
from cellctl.errors.force import MatingPlanInvalid
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.mating.contact_plan import mating_settings
from cellctl.processes.deck_to_frame.mating.plan import plan_mating
from cellctl.processes.deck_to_frame.recipe import Recipe
from cellctl.runtime.commissioned import Commissioned

ASSUMED_PAYLOAD_KG = 200.0
"""No payload is identified yet; heavier ones are judged again with the deck at the stand-off."""


def plan_problems(config: CellConfig) -> Iterator[Problem]:
    """Every recipe that ends in ``MatingPlanInvalid`` even where all is measured exactly."""
    for index, recipe in enumerate(config.recipes):
        try:
            _plan_at_the_stand_off(config, recipe)
        except MatingPlanInvalid as error:
            number, force_n = error.number, recipe.mating.target_force_n
            yield Problem(f"recipes.{index}.mating", f"target {force_n:g} N", error.detail, number)


def _plan_at_the_stand_off(config: CellConfig, recipe: Recipe) -> None:
    stand_off_m = (recipe.deck_thickness_mm + recipe.stand_off_mm) * MM
    plan_mating(
        base_T_flange=RigidTransform.identity(),
        flange_T_deck=pose_from_xyzabc(recipe.flange_T_deck),
        flange_T_sensor=pose_from_xyzabc(config.robots.main.flange_T_sensor),
        M_T_D=UncertainPose.exact(RigidTransform.from_translation([0.0, 0.0, stand_off_m])),
        deck_thickness_m=recipe.deck_thickness_mm * MM,
        over_travel_m=recipe.over_travel_mm * MM,
        settings=mating_settings(config, recipe, Commissioned(), ASSUMED_PAYLOAD_KG),
    )
