import json

import numpy as np
import pytest
from scipy.stats import chi2

from cellctl.calibration.solvers.base_frame.axis_fit import AxisStop
from cellctl.calibration.solvers.base_frame.base_frame import (
    ArmGeometry,
    BaseFrameResult,
    calibrate_base_frame,
)
from cellctl.calibration.solvers.base_frame.base_frame_picture import base_frame_picture
from cellctl.errors.calibration import AxisMotionInvalid
from cellctl.geometry.pose import pose_error
from cellctl.interfaces.target_tracker import Target
from tests.rigs.calibration.turned_arm import (
    ARM,
    C_T_BASE,
    NOISE,
    RING,
    SIGMA_M,
    Array,
    calibrate,
    flange,
    sweep,
)


def error(result: BaseFrameResult) -> Array:
    return np.concatenate(pose_error(C_T_BASE, result.c_T_base.pose))


@pytest.mark.parametrize("seeds", [2, pytest.param(20, marks=pytest.mark.figures)])
def test_accuracy_and_honest_covariance(seeds: int) -> None:
    results = [calibrate(seed) for seed in range(seeds)]
    errors = np.stack([error(result) for result in results])
    rms = np.sqrt((errors**2).mean(axis=0))
    assert (rms[:3] < 6e-5).all()
    assert (np.degrees(rms[3:]) < 0.002).all()
    total = sum(
        float(e @ np.linalg.solve(result.c_T_base.covariance, e))
        for e, result in zip(errors, results, strict=True)
    )
    band = chi2(6 * len(results)).interval(0.999)
    assert band[0] < total < band[1]
    assert all(result.passed and not result.warnings for result in results)


def test_exact_without_noise() -> None:
    rng = np.random.default_rng(0)
    stops = [sweep(rng, joint, 90) for joint in (0, 1)]
    clean = [
        [
            AxisStop(
                stop.joints_rad,
                tuple(
                    Target(t.name, (C_T_BASE * flange(stop.joints_rad)).apply(place), SIGMA_M)
                    for t, place in zip(stop.targets, RING, strict=True)
                ),
            )
            for stop in one
        ]
        for one in stops
    ]
    result = calibrate_base_frame(clean[0], clean[1], ARM, noise=NOISE)
    assert np.abs(error(result)).max() < 1e-9
    assert result.a1_m == pytest.approx(0.5, abs=1e-9)
    assert result.squareness_rad == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    "arm",
    [
        ArmGeometry(1.045, 0.5, a1_sign=-1, a1_zero_rad=0.5),
        pytest.param(ArmGeometry(1.045, 0.5, a1_sign=-1), marks=pytest.mark.figures),
        pytest.param(ArmGeometry(1.045, 0.5, a2_sign=-1), marks=pytest.mark.figures),
    ],
)
def test_other_conventions(arm: ArmGeometry) -> None:
    rng = np.random.default_rng(1)
    first, second = (sweep(rng, joint, 100, arm=arm) for joint in (0, 1))
    result = calibrate_base_frame(first, second, arm, noise=NOISE)
    assert np.abs(error(result)[:3]).max() < 3e-4
    assert np.degrees(np.abs(error(result)[3:]).max()) < 0.01


def test_wrong_sign_of_a1_is_out_of_limits() -> None:
    rng = np.random.default_rng(1)
    first, second = (sweep(rng, joint, 100) for joint in (0, 1))
    result = calibrate_base_frame(first, second, ArmGeometry(1.045, 0.5, a2_sign=-1), noise=NOISE)
    assert not result.passed
    assert result.a1_m == pytest.approx(-0.5, abs=1e-3)


def test_one_target_and_short_arc_are_warned_of() -> None:
    result = calibrate(0, 45, targets=1)
    assert len(result.warnings) == 4
    assert any("A1 turned by 45° only" in warning for warning in result.warnings)
    assert any("A2 was seen with a single target" in warning for warning in result.warnings)
    assert result.c_T_base.sigma[:3].max() > 3 * calibrate(0).c_T_base.sigma[:3].max()


def test_hidden_targets_are_no_problem() -> None:
    rng = np.random.default_rng(4)
    first, second = (sweep(rng, joint, 100) for joint in (0, 1))
    partly = [
        AxisStop(stop.joints_rad, stop.targets[number % 3 :]) for number, stop in enumerate(first)
    ]
    result = calibrate_base_frame(partly, second, ARM, noise=NOISE)
    assert np.abs(error(result)[:3]).max() < 3e-4


def test_another_axis_moved() -> None:
    rng = np.random.default_rng(4)
    first, second = (sweep(rng, joint, 100) for joint in (0, 1))
    with pytest.raises(AxisMotionInvalid, match="A2 moved by"):
        calibrate_base_frame(second, second, ARM)
    with pytest.raises(AxisMotionInvalid, match="A1: 3 stops"):
        calibrate_base_frame(first[:3], second, ARM)


def test_confused_targets_do_not_pass() -> None:
    rng = np.random.default_rng(4)
    first, second = (sweep(rng, joint, 100) for joint in (0, 1))
    names = ("F2", "F1", "F3", "F4", "F5", "F6")
    confused = tuple(
        Target(name, target.position_m, target.sigma_m)
        for name, target in zip(names, first[5].targets, strict=True)
    )
    first[5] = AxisStop(first[5].joints_rad, confused)
    result = calibrate_base_frame(first, second, ARM)
    assert not result.passed
    worst = max(result.residuals_m, key=lambda name: result.residuals_m[name])
    assert worst in {"A1 6:F1", "A1 6:F2"}


def test_record_and_picture() -> None:
    result = calibrate(2)
    again = BaseFrameResult.from_record(json.loads(json.dumps(result.to_record())))
    np.testing.assert_allclose(
        again.c_T_base.pose.as_matrix(), result.c_T_base.pose.as_matrix(), atol=1e-12
    )
    np.testing.assert_allclose(again.c_T_base.covariance, result.c_T_base.covariance, rtol=1e-9)
    assert again.checks == result.checks
    assert base_frame_picture(result).startswith(b"\x89PNG")
    assert base_frame_picture(again).startswith(b"\x89PNG")


def test_a_joint_without_a_reading_counts_as_moved() -> None:
    stops = [sweep(np.random.default_rng(0), joint, 90) for joint in (0, 1)]
    unread = [
        AxisStop(np.where(np.arange(6) == 4, np.nan, stop.joints_rad), stop.targets)
        for stop in stops[0]
    ]
    with pytest.raises(AxisMotionInvalid, match="A5 moved"):
        calibrate_base_frame(unread, stops[1], ARM, noise=NOISE)
