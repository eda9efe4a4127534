"""A picked module goes back onto its tray; step 46, within step 40, for one that is bad."""

from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.moves.places import raised
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import Picked

NUMBER, LABEL = 46, "put back"
_DROP_M = 0.3e-3
"""The module is let go so high over where it was taken: one that is pressed onto its tray trips
the guard, and the arm comes back to a height only as well as it repeats and has drifted."""


async def put_back(picked: Picked) -> None:
    """Across, then straight down to where it was gripped, open, and up again.

    Raises the trip of a module that touches something on its way down, and leaves it gripped then.
    """
    run, height_m = picked.run, picked.run.recipe.grip_approach_mm * MM
    above = raised(picked.base_T_grip, height_m)
    here = run.cell.arm.robot.state().base_T_flange
    # Not obliquely: what stands beside camera II may be hardly lower than the plug.
    higher_m = max(0.0, float(here.translation[2] - above.translation[2]))
    await run.mover.to(raised(above, higher_m))
    await run.mover.to(above)
    await run.mover.slowly_to(raised(picked.base_T_grip, _DROP_M))
    await run.cell.gripper.open()
    await run.mover.slowly_to(above)


async def put_back_bad(picked: Picked) -> None:
    """Step 46: so that nobody has to reach for it, and nothing can begin with this module held."""
    run = picked.run
    inspecting = run.board.current
    await enter(run, NUMBER, LABEL)
    await put_back(picked)
    # What ends the run was found in the step before.
    await enter(run, inspecting.step, inspecting.step_label)


async def enter(run: PluggingRun, number: int, label: str) -> None:
    """Show the line, and record, a step within a step."""
    run.board.update(step=number, step_label=label, message="")
    await run.recorder.phase(number, label)
