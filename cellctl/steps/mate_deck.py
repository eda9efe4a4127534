"""Step 50: lower the deck onto the frame under force (paper 2.4.2, mission A4)."""

from scipy.spatial.transform import RigidTransform

from cellctl import log
from cellctl.cell.measuring import require_unmoved
from cellctl.cell.step import Step
from cellctl.errors import CellError
from cellctl.force.detectors import Cusum
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.steps.compensate import compensate
from cellctl.steps.mate import mate_until_seated
from cellctl.steps.mating.plan import MatingPlan, plan_mating
from cellctl.steps.mating.result import MatingProgress
from cellctl.steps.mating.settings import MatingSettings
from cellctl.steps.run import AssemblyRun

_log = log.get(__name__)

ABORT_MARGIN_N = 5.0
"""The guard stops the robot this much below the limit: for its filter and the arm's way to stop."""
RELEASE_BAND_N = 5.0


async def mate_deck(run: AssemblyRun) -> None:
    """Mate, measuring and correcting again before each further try after a false seat."""
    run.board.update(force_limit_n=run.recipe.mating.limit_force_n)

    async def measured_plan(attempt: int) -> MatingPlan:
        if attempt > 1:
            run.board.update(step=Step.COMPENSATE)
            await compensate(run)
            run.board.update(step=Step.MATE)
        plan = _plan(run)
        await run.journal.mating_plan(plan)
        return plan

    def report(progress: MatingProgress) -> None:
        run.board.update(message=progress.phase.value)
        run.journal.mating_progress(progress)

    try:
        result = await mate_until_seated(
            run.cell.main, run.cell.guard, measured_plan, report, run.recipe.mating.max_tries
        )
    except BaseException as reason:
        await _keep_curves_of_failure(run, reason)
        raise
    await _keep_curves(run)
    await run.journal.mating_result(result)


async def _keep_curves(run: AssemblyRun) -> None:
    run.board.update(force_peaks=run.journal.force_peaks())
    await run.journal.force_curves()


async def _keep_curves_of_failure(run: AssemblyRun, reason: BaseException) -> None:
    """The curve belongs to the fault; a disk that fails now must not hide it."""
    try:
        await _keep_curves(run)
    except CellError as second:
        reason.add_note(f"force curve not kept: {second}")
        _log.error("force curve not kept", fault=str(second))


def _plan(run: AssemblyRun) -> MatingPlan:
    """From the pose that was measured, which must still be the present one."""
    assert run.flange_T_deck is not None
    assert run.M_T_D is not None
    assert run.measured_at is not None
    require_unmoved("the main robot", run.cell.main, run.measured_at)
    recipe = run.recipe
    return plan_mating(
        base_T_flange=run.cell.main.state().base_T_flange,
        flange_T_deck=run.flange_T_deck,
        flange_T_sensor=_flange_T_sensor(run),
        M_T_D=run.M_T_D,
        deck_thickness_m=recipe.deck_thickness_mm * MM,
        over_travel_m=recipe.over_travel_mm * MM,
        settings=_settings(run),
    )


def _flange_T_sensor(run: AssemblyRun) -> RigidTransform:
    return pose_from_xyzabc(run.cell.config.robots.main.flange_T_sensor)


def _settings(run: AssemblyRun) -> MatingSettings:
    """The recipe's figures in SI."""
    mating = run.recipe.mating
    return MatingSettings(
        stop_latency_s=mating.stop_latency_ms / 1e3,
        stiffness_n_m=mating.stiffness_n_per_mm / MM,
        target_force_n=mating.target_force_n,
        limit_force_n=mating.limit_force_n,
        abort_force_n=mating.limit_force_n - ABORT_MARGIN_N,
        release_low_n=mating.release_force_n - RELEASE_BAND_N,
        release_high_n=mating.release_force_n + RELEASE_BAND_N,
        touch=Cusum(drift_n=mating.touch_force_n / 2),
        stale_s=run.cell.config.force.stale_ms / 1e3,
        flange_age_s=run.cell.config.force.flange_age_ms / 1e3,
        fast_speed_m_s=mating.fast_speed_mm_s * MM,
        acceleration_m_s2=mating.acceleration_mm_s2 * MM,
        greatest_past_m=mating.max_past_contact_mm * MM,
        window_m=mating.contact_window_mm * MM,
        max_lateral_n=mating.max_lateral_force_n,
        max_moment_n_m=mating.max_moment_n_m,
    )
