"""Step 45, within step 40: a badly gripped module is put back and gripped again, once."""

from cellctl.processes.antenna_module.faults.connector import ConnectorMisplaced
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.state import Picked
from cellctl.processes.antenna_module.steps.find_module import find_on_tray
from cellctl.processes.antenna_module.steps.pick import pick
from cellctl.processes.antenna_module.steps.putting_back import enter, put_back

NUMBER, LABEL = 45, "grip again"


async def grip_again(picked: Picked, fault: ConnectorMisplaced) -> Picked:
    """Put the module back onto its tray, find it there anew, and pick it.

    ``fault`` says how it was gripped. Raises what finding and picking raise, and the trip of a
    module that touches something on its way down: nothing goes on after a force fault.
    """
    run = picked.run
    inspecting = run.board.current
    await enter(run, NUMBER, LABEL)
    await run.recorder.document(keys.REGRIP, {"first_grip": fault.detail})
    await put_back(picked)
    again = await pick(await find_on_tray(run, "tray-again"))
    await enter(run, inspecting.step, inspecting.step_label)
    return again
