"""Checks that a mating can be planned from a recipe's figures, before anything moves."""

from collections.abc import Iterator

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.devices import ForceSensorConfig
from cellctl.config.issue import ConfigIssue
from cellctl.errors.config import UnknownDriver
from cellctl.errors.force import ContactPlanInvalid
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.mating.plan import plan_mating
from cellctl.processes.deck_to_frame.mating.planned_settings import mating_settings
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import FORCE, MAIN

ASSUMED_PAYLOAD_KG = 200.0
"""Load to plan with where the cell file states none. The identified payload is judged again at the
stand-off."""


def plan_issues(cell: CellConfig, recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """An issue for a recipe from which no mating can be planned, even with exact measurements."""
    sensor = cell.force_sensors[recipe.device(FORCE)]
    load = cell.robots[recipe.device(MAIN)].load
    payload_kg = ASSUMED_PAYLOAD_KG if load is None else load.mass_kg - load.not_weighed_kg
    try:
        _plan_at_the_stand_off(sensor, recipe, payload_kg)
    except UnknownDriver:
        return  # reported by itself; without its driver the rate of the sensor is not known
    except ContactPlanInvalid as error:
        value = f"target {recipe.mating.target_force_n:g} N"
        yield ConfigIssue(f"{key}.mating", value, error.detail, error.number)


def _plan_at_the_stand_off(
    sensor: ForceSensorConfig, recipe: DeckRecipe, payload_kg: float
) -> None:
    stand_off_m = (recipe.deck_thickness_mm + recipe.stand_off_mm) * MM
    plan_mating(
        base_T_flange=RigidTransform.identity(),
        flange_T_deck=pose_from_xyzabc(recipe.flange_T_deck),
        flange_T_sensor=pose_from_xyzabc(sensor.flange_T_sensor),
        M_T_D=UncertainPose.exact(RigidTransform.from_translation([0.0, 0.0, stand_off_m])),
        deck_thickness_m=recipe.deck_thickness_mm * MM,
        over_travel_m=recipe.over_travel_mm * MM,
        settings=mating_settings(sensor, recipe, Commissioned(), payload_kg),
    )
