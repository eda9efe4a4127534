import numpy as np
import pytest

from cellctl.geometry.pose import MM, pose_from_xyzabc, pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.faults import (
    CorrectionDiverging,
    CorrectionImplausible,
    CorrectionLimitReached,
    NoProgress,
    UncertaintyTooLarge,
)
from cellctl.processes.deck_to_frame.poses.pose_correction import (
    CorrectionLimits,
    Judgement,
    Thresholds,
    assembly_error,
    check_correction,
    check_progress,
    check_uncertainty,
    flange_target,
    judge_pose,
    next_target,
    target_M_T_D,
)

BASE_T_C1 = pose_from_xyzabc([1500, -900, 900, 5, 10, 175])
C1_T_M = pose_from_xyzabc([450, 200, 510, 1, -9, 181])
FLANGE_T_DECK = pose_from_xyzabc([2, -1, 502, 0.3, 0.2, 180.1])
THRESHOLDS, LIMITS = Thresholds(), CorrectionLimits()
TARGET = target_M_T_D(15 * MM, 10 * MM)


def judgement(x_mm: float, sigma_mm: float = 0.005, rz_deg: float = 0.0) -> Judgement:
    error = np.array([x_mm * MM, 0, 0, 0, 0, np.radians(rz_deg)])
    sigma = np.array([sigma_mm * MM] * 3 + [np.radians(0.0005)] * 3)
    return Judgement(
        error, sigma, bool((np.abs(error) <= THRESHOLDS.vector).all()), sigma_mm < 0.016
    )


def test_eq_5_puts_the_deck_at_its_stand_off() -> None:
    assert np.allclose(pose_to_xyzabc(TARGET), [0, 0, 25, 0, 0, 0])


def test_eq_7_and_9_close_the_chain() -> None:
    base_T_flange = flange_target(BASE_T_C1, C1_T_M, TARGET, FLANGE_T_DECK)
    c1_T_D = BASE_T_C1.inv() * base_T_flange * FLANGE_T_DECK
    assert np.abs(assembly_error(TARGET, C1_T_M.inv() * c1_T_D)).max() < 1e-12


def test_eq_10_is_target_minus_measured() -> None:
    measured = pose_from_xyzabc([0.1, -0.2, 25.3, 0.01, 0.0, 0.0])
    error = assembly_error(TARGET, measured)
    assert np.allclose(error[:3], [-0.1 * MM, 0.2 * MM, -0.3 * MM])
    assert error[5] == pytest.approx(-np.radians(0.01))


@pytest.mark.parametrize(("method", "after_one"), [("default", 1e-12), ("paper", 1e-4)])
def test_one_correction_removes_a_wrong_hand_eye(method: str, after_one: float) -> None:
    """The cell answers a command with a constant error, as a wrong base_T_C1 makes it."""
    slip = pose_from_xyzabc([1.0, -2.0, 0.5, 0.3, 0.2, -0.1])
    commanded = TARGET
    for _ in range(2):
        measured = slip * commanded
        error = assembly_error(TARGET, measured)
        commanded = next_target(commanded, TARGET, measured, method)  # type: ignore[arg-type]
    assert np.abs(error[:3]).max() < after_one
    assert np.abs(assembly_error(TARGET, slip * commanded)).max() < 1e-6


def test_the_papers_rule_adds_components() -> None:
    commanded = pose_from_xyzabc([1, 2, 25, 0.1, 0.2, 0.3])
    measured = pose_from_xyzabc([0.4, 0.0, 24, 0.05, -0.1, 0.2])
    result = pose_to_xyzabc(next_target(commanded, TARGET, measured, "paper"))
    assert np.allclose(result, [0.6, 2.0, 26.0, 0.05, 0.3, 0.1])


def test_convergence_needs_both_a_small_error_and_a_small_uncertainty() -> None:
    near = pose_from_xyzabc([0.03, -0.02, 25.04, 0.004, 0.003, -0.002])
    sure, unsure = np.diag([1e-12] * 6), np.diag([1e-9] * 6)
    assert judge_pose(TARGET, UncertainPose(near, sure), THRESHOLDS).converged
    doubtful = judge_pose(TARGET, UncertainPose(near, unsure), THRESHOLDS)
    assert doubtful.within
    assert not doubtful.converged
    with pytest.raises(UncertaintyTooLarge, match=r"x is 0\.0316 mm after 5 frames"):
        check_uncertainty(doubtful, THRESHOLDS, 5)
    far = pose_from_xyzabc([0.03, -0.02, 25.04, 0.006, 0.003, -0.002])
    assert not judge_pose(TARGET, UncertainPose(far, sure), THRESHOLDS).within


def test_an_implausible_correction_is_refused() -> None:
    check_correction(np.array([8 * MM, 0, 0, 0, 0, 0.02]), LIMITS)
    for error in ([11 * MM, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0.03], [np.nan, 0, 0, 0, 0, 0]):
        with pytest.raises(CorrectionImplausible):
            check_correction(np.array(error), LIMITS)


def test_a_good_run_raises_nothing() -> None:
    history = [judgement(x) for x in (1.2, 0.2, 0.06, 0.04)]
    for end in range(1, 5):
        check_progress(history[:end], THRESHOLDS, LIMITS)


@pytest.mark.parametrize(
    ("errors_mm", "fault"),
    [
        ((0.5, 1.0), CorrectionDiverging),
        ((0.3, 0.31, 0.30), NoProgress),
        ((1.2, 0.9, 0.7, 0.6, 0.5, 0.4, 0.3, 0.25, 0.2), CorrectionLimitReached),
    ],
)
def test_each_way_to_fail_has_its_fault(errors_mm: tuple[float, ...], fault: type) -> None:
    history = [judgement(x) for x in errors_mm]
    check_progress(history[:-1], THRESHOLDS, LIMITS)
    with pytest.raises(fault):
        check_progress(history, THRESHOLDS, LIMITS)


def test_noise_near_the_threshold_is_not_called_divergence() -> None:
    check_progress([judgement(0.04), judgement(0.052, 0.01)], THRESHOLDS, LIMITS)
