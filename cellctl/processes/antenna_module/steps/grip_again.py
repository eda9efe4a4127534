"""Step 45, within step 40: a badly gripped module is put back and gripped again, once."""

from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.faults.connector import ConnectorMisplaced
from cellctl.processes.antenna_module.moving import raised
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import Picked
from cellctl.processes.antenna_module.steps.find_module import find_on_tray
from cellctl.processes.antenna_module.steps.pick import pick

NUMBER, LABEL = 45, "grip again"
_DROP_M = 0.3e-3
"""The module is let go so high over where it was taken: one that is pressed onto its tray trips
the guard, and the arm comes back to a height only as well as it repeats and has drifted."""


async def grip_again(picked: Picked, fault: ConnectorMisplaced) -> Picked:
    """Put the module back onto its tray, find it there anew, and pick it.

    ``fault`` says how it was gripped. Raises what finding and picking raise, and the trip of a
    module that touches something on its way down: nothing goes on after a force fault.
    """
    run = picked.run
    inspecting = run.board.current
    await _enter(run, NUMBER, LABEL)
    await run.recorder.document(keys.REGRIP, {"first_grip": fault.detail})
    await _put_back(picked)
    again = await pick(await find_on_tray(run, "tray-again"))
    await _enter(run, inspecting.step, inspecting.step_label)
    return again


async def _put_back(picked: Picked) -> None:
    """Across, then straight down to where it was gripped, open, and up again."""
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


async def _enter(run: PluggingRun, number: int, label: str) -> None:
    """Show the line, and record, the step that this is."""
    run.board.update(step=number, step_label=label, message="")
    await run.recorder.phase(number, label)
