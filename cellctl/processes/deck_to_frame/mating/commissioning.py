"""Measures the contact stiffness of the cell by touching the frame a few times."""

from dataclasses import dataclass

from cellctl.cell.guarded_motion.contact_recorder import ContactRecorder
from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.errors.force import CommissioningFailed
from cellctl.force.contact.commissioning import StiffnessEstimate, joint_stiffness
from cellctl.interfaces import Robot
from cellctl.processes.deck_to_frame.faults import DeckNotSeated
from cellctl.processes.deck_to_frame.mating.attempt import Attempt, Report
from cellctl.processes.deck_to_frame.mating.back_off import return_to_stand_off
from cellctl.processes.deck_to_frame.mating.mate import mate
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import MatingOutcome, MatingResult


@dataclass(frozen=True, slots=True)
class ContactStiffness:
    """A measured contact stiffness with the contacts that it was measured in."""

    estimate: StiffnessEstimate
    """Arm and contact in series, of all contacts together."""
    single: tuple[StiffnessEstimate, ...]
    """The estimate of each single contact."""
    contacts: tuple[MatingResult, ...]


async def measure_contact_stiffness(
    robot: Robot, guard: GuardPort, plan: MatingPlan, report: Report, contacts: int = 3
) -> ContactStiffness:
    """Arm and contact in series from ``contacts`` matings with the same plan.

    The plan must be made with an upper bound (the arm's own stiffness will do: a series is never
    stiffer). The arm stands at the stand-off before and after. Raises ``CommissioningFailed``,
    ``DeckNotSeated`` and what ``mate`` raises.
    """
    results, estimates = [], []
    for _ in range(contacts):
        result = await mate(robot, guard, plan, report)
        # On a chamfer or on dirt the stiffness of something else would be measured.
        if result.outcome is not MatingOutcome.SEATED:
            gap_mm = result.verdict.gap_m * 1e3
            raise DeckNotSeated(f"a contact ends {gap_mm:.3f} mm above the seat", result.curve)
        async with ContactRecorder(robot, guard, plan.travel_of) as recorder:
            await return_to_stand_off(Attempt(robot, guard, plan, recorder, report))
        if result.stiffness is None:
            raise CommissioningFailed("a contact gave too few readings for a stiffness")
        results.append(result)
        estimates.append(result.stiffness)
    return ContactStiffness(joint_stiffness(estimates), tuple(estimates), tuple(results))
