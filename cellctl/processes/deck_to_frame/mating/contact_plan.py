"""The plan of one contact from recipe, commissioning and what was measured."""

from cellctl.cell.readiness import require_full_speed
from cellctl.cell.standstill import require_unmoved
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan, plan_mating
from cellctl.processes.deck_to_frame.mating.planned_settings import mating_settings
from cellctl.processes.deck_to_frame.state import Corrected


def contact_plan(corrected: Corrected, commissioned: Commissioned) -> MatingPlan:
    """Plan the mating from the pose that was measured, which must still be the present one.

    Raises ``HeadMoved`` when it is not, ``SpeedOverridden`` when the robot would not move as
    planned, ``ContactPlanInvalid`` when no plan is safe.
    """
    run = corrected.run
    cell, recipe = run.cell, run.recipe
    # The plan counts the travel from the pose that was measured. An arm that has moved since then
    # would meet the frame earlier or later than expected.
    require_unmoved("the main robot", cell.main, corrected.measured_at)
    require_full_speed(cell.main)
    return plan_mating(
        base_T_flange=cell.main.state().base_T_flange,
        flange_T_deck=corrected.flange_T_deck,
        flange_T_sensor=cell.arm.flange_T_sensor,
        M_T_D=corrected.M_T_D,
        deck_thickness_m=recipe.deck_thickness_mm * MM,
        over_travel_m=recipe.over_travel_mm * MM,
        settings=mating_settings(
            cell.force_config, recipe, commissioned, run.facts.payload.mass_kg
        ),
    )
