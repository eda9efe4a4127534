"""Step 80: into the socket under force limits that follow depth."""

from cellctl import log
from cellctl.clock import now_s
from cellctl.errors import CellError
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.chain.requirements import require_fresh
from cellctl.processes.antenna_module.insertion.verdict import (
    InsertionJudgement,
)
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt
from cellctl.processes.antenna_module.pushing.back_out import back_out
from cellctl.processes.antenna_module.pushing.push_in import push_in
from cellctl.processes.antenna_module.record.insertion import record_curve, record_judgement
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import Inserted, OverSocket
from cellctl.processes.antenna_module.steps.contact import contact, limits_of

_log = log.get(__name__)


async def insert(over: OverSocket) -> Inserted:
    """Push in and judge the curve; after any fault of the contact straight out again.

    There is no second try: a module that has met a force fault belongs into quarantine. Raises the
    ``PluggingError`` of what was met, ``StaleLook``, and the faults of guard, sensor and robot.
    """
    run = over.run
    # The looks were fresh when the plan was made; nobody knows how long the way here took.
    require_fresh(over.looks, now_s(), run.recipe.max_age_s)
    run.board.update(force_limit_n=limits_of(run).greatest_n)
    async with contact(over) as attempt:
        judgement = await _pushed(run, attempt)
    return Inserted(
        run,
        over.module,
        plug=over.plug,
        flange_T_connector=over.flange_T_connector,
        looks=over.looks,
        plan=over.plan,
        judgement=judgement,
    )


async def _pushed(run: PluggingRun, attempt: PushAttempt) -> InsertionJudgement:
    insertion = run.recipe.insertion
    step_m, stand_off_m = insertion.step_mm * MM, insertion.stand_off_mm * MM
    # A trip of the guard is what this step is made to find; supervision leaves it alone.
    with run.cell.cell.trips_awaited(run.cell.arm.sensor_name):
        try:
            await run.interruption.unless(push_in(attempt, step_m))
            judgement = await _judged(run, attempt)
        except BaseException as reason:
            # Only after faults. A Stop or an Abort cancels, and what is cancelled must not begin
            # another move.
            if isinstance(reason, CellError):
                await back_out(attempt, reason, stand_off_m)
            await _keep_curve(run, attempt, reason)
            raise
    await record_curve(run, attempt.curve())
    return judgement


async def _judged(run: PluggingRun, attempt: PushAttempt) -> InsertionJudgement:
    """The verdict of the whole curve; raises its fault."""
    judgement = await attempt.judged()
    await record_judgement(run, judgement, attempt.limits)
    if judgement.fault is not None:
        raise judgement.fault
    return judgement


async def _keep_curve(run: PluggingRun, attempt: PushAttempt, reason: BaseException) -> None:
    """The curve of a contact that went wrong; a disk that fails must not hide what ended it."""
    try:
        await record_curve(run, attempt.curve())
    except CellError as second:
        reason.add_note(f"insertion curve not kept: {second}")
        _log.error("insertion curve not kept", fault=str(second))
