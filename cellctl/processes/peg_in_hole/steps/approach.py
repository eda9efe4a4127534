"""Step 10: over the believed place of the hole."""

import numpy as np

from cellctl.cell.guarded_motion.free_moves import move_joint_free
from cellctl.cell.guarded_motion.settling import settle
from cellctl.processes.peg_in_hole.roles import ABOVE_HOLE
from cellctl.processes.peg_in_hole.state import AboveHole, AtHome
from cellctl.processes.peg_in_hole.stations import believed_frames


async def approach(home: AtHome) -> AboveHole:
    """A joint move to the taught pose; the attitude there is that of the insertion."""
    run = home.run
    cell = run.facts.cell
    above_rad = np.radians(cell.arm.config.poses_deg[ABOVE_HOLE])
    await move_joint_free(cell.cell, cell.arm, above_rad)
    await settle(cell.arm.guard)
    return AboveHole(run, believed_frames(run.facts.recipe, cell.robot.state().base_T_flange))
