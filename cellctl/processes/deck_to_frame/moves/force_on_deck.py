"""Shows the force on a deck that a run has left on its frame, before anything moves."""

from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.moves.lift_off import recipe_below
from cellctl.processes.deck_to_frame.stations import DeckCell


async def show_force_on_deck(cell: DeckCell, payload: GravityCompensation) -> None:
    """Have the guard subtract the payload, and give the force in the axes of the deck; no tare.

    Which deck it is follows from where the arm stands, as for the lift off that comes next. Where
    no recipe's deck would be low over its frame, the axes stay those of the sensor. Raises the
    faults of guard and robot.
    """
    # First, for it needs no robot: without its state the magnitude of the force is still known.
    await cell.guard.set_gravity_compensation(payload)
    recipe = recipe_below(cell, cell.main.state().base_T_flange)
    if recipe is not None:
        flange_T_deck = pose_from_xyzabc(recipe.flange_T_deck)
        await cell.guard.set_wrench_frame(cell.arm.flange_T_sensor.inv() * flange_T_deck)
