"""The derivatives by which the hand-eye solution steps."""

from dataclasses import replace

import numpy as np
import pytest

from cellctl.calibration.solvers.hand_eye.hand_eye_adjustment import (
    _linearised,
    residuals_of,
)
from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.geometry.uncertain import perturbed
from tests.rigs.calibration.hand_eye_views import (
    BASE_T_BOARD,
    BASE_T_CAMERA,
    FLANGE_T_BOARD,
    FLANGE_T_CAMERA,
    NOISE,
    make_poses,
)


@pytest.mark.parametrize("setup", list(Setup))
def test_derivatives_agree_with_differences(setup: Setup) -> None:
    poses = make_poses(1, setup, 4)
    in_hand = setup is Setup.EYE_IN_HAND
    x, z = (FLANGE_T_CAMERA, BASE_T_BOARD) if in_hand else (BASE_T_CAMERA, FLANGE_T_BOARD)
    step = 1e-6
    here = _linearised(poses, setup, NOISE, x, z)
    for index, unit in enumerate(np.eye(12) * step):
        ahead = residuals_of(poses, setup, perturbed(x, unit[:6]), perturbed(z, unit[6:]))
        behind = residuals_of(poses, setup, perturbed(x, -unit[:6]), perturbed(z, -unit[6:]))
        by_differences = (ahead - behind) / (2.0 * step)
        np.testing.assert_allclose(here.design[:, :, index], by_differences, atol=1e-3)
    columns = []
    for unit in np.eye(6) * step:
        moved = [
            [
                replace(pose, base_T_flange=perturbed(pose.base_T_flange, way * unit))
                for pose in poses
            ]
            for way in (1.0, -1.0)
        ]
        ahead, behind = (residuals_of(one, setup, x, z) for one in moved)
        columns.append((ahead - behind) / (2.0 * step))
    by_robot = np.stack(columns, axis=2)
    for part, sigma, columns_of in (
        (here.parts[0], NOISE.position_m, by_robot[:, :, :3]),
        (here.parts[1], NOISE.rotation_rad, by_robot[:, :, 3:]),
    ):
        expected = sigma**2 * columns_of @ columns_of.transpose(0, 2, 1)
        np.testing.assert_allclose(part, expected, atol=1e-3 * float(expected.max()))
