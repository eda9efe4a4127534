"""What every plugged module has to be measured for, with the limits of recipe and drawings."""

import numpy as np

from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.record.insertion import judged_limits
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.records.figures import Limit
from cellctl.records.required.required_figures import RequiredFigure, required


def required_figures(run: PluggingRun, limits: InsertionLimits) -> tuple[RequiredFigure, ...]:
    """Of the plugged module first, then of the insertion, then of the way there."""
    recipe, gripper = run.recipe, run.drawings.gripper
    pull, judged = recipe.insertion, judged_limits(limits)
    turn_deg, gap_mm = recipe.seated_limit_deg, recipe.gap_limit_mm
    least, most = 1 - recipe.mass_tolerance_ratio, 1 + recipe.mass_tolerance_ratio
    mass_kg = recipe.module_mass_kg
    return (
        required(keys.PLACED, "mm", Limit(upper=recipe.seated_limit_mm)),
        required(keys.PLACED_TURN, "°", Limit(-turn_deg, turn_deg)),
        required(keys.GAP, "mm", Limit(-gap_mm, gap_mm)),
        required(keys.SEAT_DEPTH, "mm", judged[keys.SEAT_DEPTH]),
        required(keys.PULL, "N", Limit(lower=pull.pull_n)),
        required(keys.PULL_TRAVEL, "mm", Limit(upper=pull.pull_travel_mm)),
        required(keys.TOTAL, "N", judged[keys.TOTAL]),
        required(keys.SIDE, "N", judged[keys.SIDE]),
        required(keys.MOMENT_Z, "N·m", judged[keys.MOMENT_Z]),
        required(keys.WORST_CONTACT, "mm", Limit(upper=recipe.worst_contact_mm)),
        required(keys.GRIP_OFFSET, "mm", Limit(upper=gripper.within_m / MM)),
        required(keys.GRIP_TURN, "°", Limit(upper=float(np.degrees(gripper.within_rad)))),
        required(keys.MASS, "kg", Limit(mass_kg * least, mass_kg * most)),
    )
