"""Brings the cell to where every run begins: the deck clear of the station, the heads over it."""

from cellctl.processes.deck_to_frame.moves.taught_poses import (
    heads_to_measuring_poses,
    main_to_home,
)
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry, PartMeasurer
from cellctl.processes.deck_to_frame.run import AssemblyRun, OpenRun
from cellctl.processes.deck_to_frame.state import Ready


async def move_to_start(opened: OpenRun) -> Ready:
    """Go to the beginning; nothing is measured yet. Raises the faults of guard and robots."""
    facts, cell = opened.facts, opened.facts.cell
    # Before the first move: from here on the guard knows the weight, so that its limits hold
    # however the arm is tilted.
    await cell.guard.set_gravity_compensation(facts.payload.gravity_compensation)
    opened.board.update(step=0, step_label="", iteration=0, message="to the beginning")
    # The main robot first: home is clear of the heads wherever they stand, but a head on its way to
    # its measuring pose may meet a deck that is low over the station.
    await main_to_home(cell)
    # Only now: what the arm may have stood in until here was left by the run before.
    cell.memory.recipe_id = facts.recipe.id
    await heads_to_measuring_poses(cell)
    settings = facts.recipe.pose_correction
    heads = HeadGeometry.of(facts.geometry, settings)
    # Takes the poses of the heads as the reference that they must keep from here on.
    measurer = PartMeasurer(cell, heads, settings.method, opened.exposures)
    return Ready(AssemblyRun(opened, measurer))
