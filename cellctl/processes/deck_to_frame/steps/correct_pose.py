"""Step 40: measure and correct until every component is within its threshold (paper 2.3)."""

import numpy as np

from cellctl.geometry.pose import MM
from cellctl.geometry.units import in_mm_deg
from cellctl.processes.deck_to_frame.measuring import PartMeasurement
from cellctl.processes.deck_to_frame.pose_correction import (
    CorrectionLimits,
    CorrectionMethod,
    Judgement,
    check_correction,
    check_progress,
    check_uncertainty,
    flange_target,
    judge,
    next_target,
    uncertain_deck_in_frame,
)
from cellctl.processes.deck_to_frame.pose_limits import require_clearance, require_near
from cellctl.processes.deck_to_frame.run import AssemblyRun


async def compensate(run: AssemblyRun) -> None:
    """Iterate to the thresholds of the recipe, or raise what keeps it from converging.

    Iterations are numbered through the run: a further mating attempt goes on counting.
    """
    settings = run.recipe.compensation
    limits = CorrectionLimits(
        max_corrections=settings.max_iterations,
        translation_m=settings.max_correction_mm * MM,
        rotation_rad=float(np.radians(settings.max_correction_deg)),
    )
    history: list[Judgement] = []
    while True:
        await run.safe_point()
        iteration = run.journal.iterations + 1
        judgement, measurement = await _measure(run, iteration)
        history.append(judgement)
        correction = None if judgement.converged else judgement.error
        await run.journal.iteration(iteration, judgement, run.thresholds, measurement, correction)
        if correction is None:
            return
        check_uncertainty(judgement, run.thresholds, measurement.frames)
        check_progress(history, run.thresholds, limits)
        check_correction(correction, limits)
        await _correct(run)


async def _measure(run: AssemblyRun, iteration: int) -> tuple[Judgement, PartMeasurement]:
    """Measure the deck at the stand-off and judge it against the target (eq. 9, 10, 16)."""
    assert run.c1_T_M is not None
    assert run.base_T_flange is not None
    assert run.flange_T_deck is not None
    predicted = run.base_T_c1.inv() * run.base_T_flange * run.flange_T_deck
    measurement = await run.measure(run.deck_features, predicted)
    run.M_T_D = uncertain_deck_in_frame(run.c1_T_M, measurement.own)
    run.measured_at = measurement.base_T_flange
    judgement = judge(run.target_M_T_D, run.M_T_D, run.thresholds)
    run.board.update(iteration=iteration, error_mm_deg=tuple(in_mm_deg(judgement.error).tolist()))
    return judgement, measurement


async def _correct(run: AssemblyRun) -> None:
    """Equations 11 to 15: command the deck anew from what was measured.

    However many corrections add up, the deck stays near its stand-off and away from the frame.
    """
    assert run.c1_T_M is not None
    assert run.M_T_D is not None
    assert run.flange_T_deck is not None
    rule: CorrectionMethod = "default" if run.recipe.compensation.rule == "compose" else "paper"
    commanded = next_target(run.commanded[-1], run.target_M_T_D, run.M_T_D.pose, rule)
    require_clearance(run.recipe, run.deck_features, commanded)
    require_near("commanded deck", run.recipe, run.target_M_T_D, commanded)
    run.commanded.append(commanded)
    run.base_T_flange = flange_target(run.base_T_c1, run.c1_T_M.pose, commanded, run.flange_T_deck)
    await run.move_flange(run.base_T_flange)
