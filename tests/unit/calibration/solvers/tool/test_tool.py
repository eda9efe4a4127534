import json

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform
from scipy.stats import chi2

from cellctl.calibration.solvers.tool.tool import ToolResult, calibrate_tool
from cellctl.calibration.solvers.tool.tool_picture import tool_picture
from cellctl.errors.calibration import IllConditioned, PosesNotDiverse
from cellctl.geometry.pose import pose_error, pose_from_xyzabc
from tests.rigs.calibration.tool_touches import FLANGE_T_TOOL, orienting, touching

SIGMA_M = 1e-4


def test_exact_from_four_and_three_points() -> None:
    rng = np.random.default_rng(0)
    result = calibrate_tool(touching(rng, 4, 0), orienting(rng, 0))
    np.testing.assert_allclose(
        result.flange_T_tool.pose.as_matrix(), FLANGE_T_TOOL.as_matrix(), atol=1e-9
    )
    assert max(result.residuals_m) < 1e-9
    assert 1 <= result.conditioning < 5


@pytest.mark.parametrize("trials", [25, pytest.param(200, marks=pytest.mark.figures)])
def test_covariance_is_honest(trials: int) -> None:
    total_m, total_rad = 0.0, 0.0
    for seed in range(trials):
        rng = np.random.default_rng(seed)
        result = calibrate_tool(
            touching(rng, 5, SIGMA_M), orienting(rng, SIGMA_M), touch_sigma_m=SIGMA_M
        )
        covariance = result.flange_T_tool.covariance
        off_m, off_rad = pose_error(FLANGE_T_TOOL, result.flange_T_tool.pose)
        total_m += float(off_m @ np.linalg.solve(covariance[:3, :3], off_m))
        total_rad += float(off_rad @ np.linalg.solve(covariance[3:, 3:], off_rad))
    band = chi2(3 * trials).interval(0.999)
    assert band[0] < total_rad < band[1]
    assert 0.6 * band[0] < total_m < band[1]  # takes the larger of stated and observed noise


def test_without_orientation_the_axes_are_the_flange_s() -> None:
    result = calibrate_tool(touching(np.random.default_rng(0), 4, 0))
    assert result.flange_T_tool.pose.rotation.magnitude() == 0
    assert "not measured" in result.method
    assert not any("rotation" in check.name for check in result.checks), "nothing to judge"


def test_a_slipped_tip_shows() -> None:
    poses = touching(np.random.default_rng(0), 5, 0)
    poses[2] = RigidTransform.from_translation([0.002, 0, 0]) * poses[2]
    result = calibrate_tool(poses)
    assert not result.passed
    assert max(result.residuals_m) > 5e-4


def test_refusals() -> None:
    rng = np.random.default_rng(0)
    good = touching(rng, 4, 0)
    with pytest.raises(PosesNotDiverse, match="3 touching poses"):
        calibrate_tool(good[:3])
    with pytest.raises(PosesNotDiverse, match="too little"):
        calibrate_tool([good[0]] * 4)
    about_z = [good[0] * pose_from_xyzabc([0, 0, 0, angle, 0, 0]) for angle in (0, 30, 60, 90)]
    with pytest.raises(PosesNotDiverse, match="one direction only"):
        calibrate_tool(about_z)
    three = orienting(rng, 0)
    with pytest.raises(PosesNotDiverse, match="three poses, got 2"):
        calibrate_tool(good, three[:2])
    with pytest.raises(IllConditioned, match="at least 20 mm"):
        calibrate_tool(good, [three[0], three[0], three[2]])
    middle = RigidTransform.from_components(
        (three[0].translation + three[1].translation) / 2, three[0].rotation
    )
    with pytest.raises(IllConditioned, match="on a line"):
        calibrate_tool(good, [three[0], three[1], middle])
    with pytest.raises(PosesNotDiverse, match="turned by"):
        calibrate_tool(good, [three[0], three[1], good[1]])


def test_record_and_picture() -> None:
    rng = np.random.default_rng(3)
    result = calibrate_tool(touching(rng, 5, SIGMA_M), orienting(rng, SIGMA_M))
    again = ToolResult.from_record(json.loads(json.dumps(result.to_record())))
    np.testing.assert_allclose(
        again.flange_T_tool.pose.as_matrix(), result.flange_T_tool.pose.as_matrix(), atol=1e-12
    )
    assert again.checks == result.checks
    assert tool_picture(again).startswith(b"\x89PNG")
