"""Contact stiffness of the cell, measured by touching the frame a few times."""

import numpy as np

from cellctl.errors.force import CommissioningFailed
from cellctl.force.commissioning import StiffnessEstimate
from cellctl.interfaces import Robot
from cellctl.steps.mate import mate
from cellctl.steps.mating.attempt import Report
from cellctl.steps.mating.plan import MatingPlan
from cellctl.steps.mating.ports import GuardPort
from cellctl.steps.mating.result import MatingOutcome


async def measure_contact_stiffness(
    robot: Robot, guard: GuardPort, plan: MatingPlan, report: Report, contacts: int = 3
) -> StiffnessEstimate:
    """Arm and contact in series from ``contacts`` matings with the same plan.

    The plan must be made with an upper bound (the arm's own stiffness will do: a series is never
    stiffer). The arm stands at the stand-off before and after. The scatter between contacts is
    part of the result's sigma. Raises ``CommissioningFailed`` and what ``mate`` raises.
    """
    estimates = []
    for _ in range(contacts):
        result = await mate(robot, guard, plan, report)
        if result.outcome is MatingOutcome.SEATED:
            await robot.move_linear(
                plan.base_T_flange,
                speed_m_s=plan.settings.back_off_speed_m_s,
                acceleration_m_s2=plan.settings.acceleration_m_s2,
            )
        if result.stiffness is None:
            raise CommissioningFailed("a contact gave too few readings for a stiffness")
        estimates.append(result.stiffness)
    slopes = np.array([estimate.stiffness_n_m for estimate in estimates])
    inner = np.mean([estimate.sigma_n_m**2 for estimate in estimates])
    outer = slopes.var(ddof=1) if contacts > 1 else 0.0
    return StiffnessEstimate(
        stiffness_n_m=float(slopes.mean()),
        sigma_n_m=float(np.sqrt(inner + outer)),
        contact_m=float(np.mean([estimate.contact_m for estimate in estimates])),
        residual_n=float(np.mean([estimate.residual_n for estimate in estimates])),
    )
