"""Step 40: measure and correct until every component is within its threshold (paper 2.3)."""

from dataclasses import replace

import numpy as np

from cellctl.geometry.pose import MM
from cellctl.geometry.uncertain import UncertainPose
from cellctl.geometry.units import in_mm_deg
from cellctl.processes.deck_to_frame.poses.part_measurer import PartMeasurement
from cellctl.processes.deck_to_frame.poses.pose_correction import (
    CorrectionLimits,
    CorrectionMethod,
    Judgement,
    check_correction,
    check_progress,
    check_uncertainty,
    flange_target,
    judge_pose,
    next_target,
)
from cellctl.processes.deck_to_frame.poses.pose_limits import require_clearance, require_near
from cellctl.processes.deck_to_frame.recipe import PoseCorrection
from cellctl.processes.deck_to_frame.state import AtStandOff, Corrected

NUMBER, LABEL = 40, "correct pose"
"""A further mating attempt comes back to this step, and says so."""


async def correct_pose(stand_off: AtStandOff) -> Corrected:
    """Iterate to the thresholds of the recipe, or raise what keeps it from converging.

    Iterations are numbered through the run: a further mating attempt goes on counting.
    """
    run = stand_off.run
    limits = _limits(run.recipe.pose_correction)
    history: list[Judgement] = []
    while True:
        # Before each measurement, because a Hold makes the earlier ones worthless.
        await run.obey_hold()
        iteration = run.recorder.iterations + 1
        judgement, measurement, M_T_D = await _measure(stand_off, iteration)
        history.append(judgement)
        correction = None if judgement.converged else judgement.error
        # Written before the checks, so that the pass that fails is in the record too.
        await run.recorder.iteration(iteration, judgement, run.thresholds, measurement, correction)
        if correction is None:
            return _corrected(stand_off, measurement, M_T_D)
        # Uncertainty first: a measurement that knows too little must not be judged for progress,
        # nor be corrected by.
        check_uncertainty(judgement, run.thresholds, measurement.frames)
        check_progress(history, run.thresholds, limits)
        check_correction(correction, limits)
        stand_off = await _correct(stand_off, M_T_D)


def _limits(settings: PoseCorrection) -> CorrectionLimits:
    return CorrectionLimits(
        max_corrections=settings.max_iterations,
        translation_m=settings.max_correction_mm * MM,
        rotation_rad=float(np.radians(settings.max_correction_deg)),
    )


async def _measure(
    stand_off: AtStandOff, iteration: int
) -> tuple[Judgement, PartMeasurement, UncertainPose]:
    """Measure the deck at the stand-off and judge it against the target (eq. 9, 10, 16)."""
    run = stand_off.run
    predicted = run.base_T_c1.inv() * stand_off.base_T_flange * stand_off.flange_T_deck
    measurement = await run.measure(run.facts.deck_features, predicted)
    M_T_D = run.measurer.deck_in_frame(stand_off.frame, measurement.pose).part_1_T_part_2
    judgement = judge_pose(run.target_M_T_D, M_T_D, run.thresholds)
    run.board.update(
        iteration=iteration,
        error_mm_deg=tuple(in_mm_deg(judgement.error).tolist()),
        error_limits_mm_deg=tuple(in_mm_deg(run.thresholds.vector).tolist()),
    )
    return judgement, measurement, M_T_D


async def _correct(stand_off: AtStandOff, M_T_D: UncertainPose) -> AtStandOff:
    """Equations 11 to 15: command the deck anew from what was measured.

    However many corrections add up, the deck stays near its stand-off and away from the frame.
    """
    run = stand_off.run
    rule: CorrectionMethod = "default" if run.recipe.pose_correction.rule == "compose" else "paper"
    commanded = next_target(stand_off.commanded, run.target_M_T_D, M_T_D.pose, rule)
    require_clearance(run.recipe, run.facts.deck_features, commanded)
    require_near("commanded deck", run.recipe, run.target_M_T_D, commanded)
    base_T_flange = flange_target(
        run.base_T_c1, stand_off.c1_T_M, commanded, stand_off.flange_T_deck
    )
    await run.recorder.commanded(base_T_flange)
    await run.move_near_frame(base_T_flange, stand_off.flange_T_deck)
    return replace(stand_off, commanded=commanded, base_T_flange=base_T_flange)


def _corrected(
    stand_off: AtStandOff, measurement: PartMeasurement, M_T_D: UncertainPose
) -> Corrected:
    return Corrected(
        stand_off.run,
        stand_off.frame,
        stand_off.flange_T_deck,
        stand_off.commanded,
        stand_off.base_T_flange,
        M_T_D=M_T_D,
        measured_at=measurement.base_T_flange,
    )
