"""Step 30: search, insertion and verdict within one stream."""

import numpy as np

from cellctl.errors.base import CellError
from cellctl.processes.peg_in_hole.cycle import search_and_insert
from cellctl.processes.peg_in_hole.face import TouchedFace
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.record.cycle import record_cycle
from cellctl.processes.peg_in_hole.state import FaceTouched, PegInserted
from cellctl.processes.peg_in_hole.steps.contact import contact
from cellctl.processes.peg_in_hole.steps.touch_face import CLEAR_M

_FREE_M_S = 10e-3
_DOWN = np.array([0.0, 0.0, 1.0])
_ON_FACE = TouchedFace(0.0, np.zeros(2), 0.0, 0.0)
"""Frame A lies on the face."""


async def find_and_insert(touched: FaceTouched) -> PegInserted:
    """Raises the faults of search, insertion and verdict; the peg stays where it is then."""
    run, plan = touched.run, touched.run.facts.plan
    await run.recorder.document(keys.CHOICE, plan.choice.to_record())
    async with contact(run, touched.frames, keys.INSERTION) as motions:
        # Upright on the face now, over its middle.
        await motions.move_free(np.array([0.0, 0.0, -CLEAR_M]), np.zeros(3), _FREE_M_S)
        await motions.touch(_DOWN, 2 * CLEAR_M, plan.task.limits.search_n)
        try:
            result = await search_and_insert(motions, plan, _ON_FACE, run.say)
        except CellError:
            # What was felt on the way is in the record; the stream ends at standstill.
            await motions.back_out(CLEAR_M)
            raise
    await record_cycle(run, result)
    fault = result.judgement.fault
    if fault is not None:
        raise fault
    return PegInserted(run, touched.frames, result)
