"""Step 30: search, insertion and verdict within one stream."""

from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.errors.base import CellError
from cellctl.processes.peg_in_hole.cycle import (
    CycleLog,
    CycleResult,
    search_and_insert,
)
from cellctl.processes.peg_in_hole.offline.judged_part import judged_part
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.record.cycle import (
    choice_record,
    record_cycle,
    record_failure,
    record_search,
)
from cellctl.processes.peg_in_hole.run import PegRun
from cellctl.processes.peg_in_hole.state import FaceTouched, PegInserted
from cellctl.processes.peg_in_hole.steps.backing_out import back_out_after
from cellctl.processes.peg_in_hole.steps.contact import contact, watch_phase


async def find_and_insert(touched: FaceTouched) -> PegInserted:
    """Raises the faults of search, insertion and verdict; after most the peg is drawn out."""
    run, plan = touched.run, touched.run.facts.plan
    await run.recorder.document(keys.CHOICE, choice_record(plan))
    part = judged_part(run.facts.recipe, plan, touched.face_yields_m)
    await run.recorder.document(keys.TASK, part.model_dump(mode="json"))
    log = CycleLog.of(plan)
    try:
        async with contact(run, touched.frames, keys.INSERTION) as motions:
            result = await _cycle(run, motions, touched.face_yields_m, log)
    except CellError as fault:
        await record_failure(run.recorder, log, fault)
        raise
    finally:
        # Whatever came of it: map and path show where a search has looked that found nothing.
        await record_search(run.recorder, log)
    return PegInserted(run, touched.frames, touched.face_yields_m, result)


async def _cycle(
    run: PegRun, motions: StreamedContact, face_yields_m: float, log: CycleLog
) -> CycleResult:
    plan = run.facts.plan

    async def begin(phase: CyclePhase, words: str) -> None:
        run.say(words)
        await watch_phase(run, motions, phase)

    try:
        result = await search_and_insert(motions, plan, face_yields_m, log, begin)
        # Before the arm leaves the part: what was found is on the disk then, also when the way out
        # fails.
        await motions.hold_while(record_cycle(run, result))
        if result.judgement.fault is not None:
            raise result.judgement.fault
    except CellError as fault:
        run.say(await back_out_after(fault, motions))
        raise
    return result
