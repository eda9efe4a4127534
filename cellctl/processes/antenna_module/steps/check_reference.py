"""Step 10: has anything moved since the cell was calibrated and the plug was taught?"""

from dataclasses import replace
from datetime import timedelta

from cellctl import log
from cellctl.clock import utc_now
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.calibrations import REFERENCE
from cellctl.processes.antenna_module.chain.reference.reference_check import (
    ReferenceReading,
    further_looks,
    furthest_m,
    require_nothing_moved,
)
from cellctl.processes.antenna_module.chain.reference.reference_looks import ReferenceLooks
from cellctl.processes.antenna_module.chain.reference.taught_reference import TaughtReference
from cellctl.processes.antenna_module.moves.reference_drive import ReferenceDrive
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import GripperEmpty

_log = log.get(__name__)


async def check_reference(ready: GripperEmpty) -> GripperEmpty:
    """Look at gripper marks and plate where that is due; few times, and again when in doubt.

    Gives back what it is given: nothing has moved. Raises the ``ReferenceMoved`` of the device that
    has, ``LooksIncomplete`` or ``TurnInvalid``. Does nothing in a cell without a reference plate.
    """
    run = ready.run
    taught, section = run.facts.reference, run.cell.settings.reference
    if taught is None or section is None:
        return ready
    begun = utc_now()
    made = run.facts.calibrations.stored[REFERENCE.name].made
    if run.last_check.due(begun, made, timedelta(hours=section.every_h)):
        await _check(run, taught, section.looks)
        run.last_check.passed = begun
    return ready


async def _check(run: PluggingRun, taught: TaughtReference, count: int) -> None:
    arm = run.facts.plug_cell.arm
    looks = await _looks(run, count, first=1)
    now = looks.reading(arm)
    # Few looks find what has moved, and take one time in five for moved what has not: the noise of
    # the arm. More of them tell both apart, and the good check stays short.
    while more := further_looks(taught.reading, now, first=count, taken=len(looks.turns)):
        looks += await _looks(run, more, first=len(looks.turns) + 1)
        now = looks.reading(arm)
    # Before the judgement: what moved is worth most where the check fails.
    await _record(run, taught.reading, now)
    warmed = require_nothing_moved(taught.reading, now, arm.drift_m)
    if warmed is not None:
        run.say("the arm has warmed up since the reference was taught")
        _log.warning("arm drifted within its figure", detail=warmed.detail)


async def _looks(run: PluggingRun, count: int, *, first: int) -> ReferenceLooks:
    async def tell(number: int, total: int) -> None:
        run.say(f"look {number} of {total}")

    plate = run.facts.required_plate
    # One image a look: the arm repeats ten times worse than an image shows.
    eyes = replace(run.eyes, frames=1)
    return await ReferenceDrive(run.facts, plate, eyes, tell).looks(count, first=first)


async def _record(run: PluggingRun, taught: ReferenceReading, now: ReferenceReading) -> None:
    axis, marks, plate_1, plate_2 = ((now.stacked() - taught.stacked()) / MM).tolist()
    content = {
        "axis_in_camera_2_mm": axis,
        "marks_from_axis_mm": marks,
        "plate_in_camera_1_mm": plate_1,
        "plate_in_camera_2_mm": plate_2,
        "sigma_mm": now.sigma_m / MM,
    }
    await run.recorder.document(keys.REFERENCE, content)
    await run.recorder.figure(keys.REFERENCE_MOVED, furthest_m(taught, now) / MM, "mm")
