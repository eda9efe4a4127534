"""The file of a hand-eye calibration: which intrinsics, and one way of folding the arm."""

from collections.abc import Sequence
from typing import Any

import pytest

from cellctl.calibration.solvers.hand_eye.hand_eye_input import HandEyeFile
from cellctl.errors.calibration import WristConfigurationsDiffer

POSE = [100, 200, 300, 10, 20, 30]
FOLDED = [10, -40, 95, 5, 40, 20]


def file(*joints_deg: Sequence[float] | None, **extra: Any) -> HandEyeFile:
    poses = [
        {"base_T_flange": POSE, "camera_T_board": POSE, "joints_deg": joints}
        for joints in joints_deg
    ]
    return HandEyeFile.model_validate({"poses": poses, **extra})


def test_poses_of_one_wrist_are_taken() -> None:
    assert len(file(FOLDED, FOLDED, None, camera_id="ab12").stops()) == 3
    assert len(file(None, None).stops()) == 2


def test_a_pose_of_another_wrist_is_named() -> None:
    flipped = [10, -40, 95, 185, -40, 200]
    with pytest.raises(WristConfigurationsDiffer, match="otherwise in pose 2"):
        file(FOLDED, flipped, FOLDED).stops()


def test_joints_are_six_numbers() -> None:
    with pytest.raises(ValueError, match="six numbers"):
        file([1.0, 2.0])


def test_two_poses_of_one_name_are_refused() -> None:
    named = [{"name": name, "base_T_flange": POSE, "camera_T_board": POSE} for name in ("a", "a")]
    with pytest.raises(ValueError, match="'a' is given to 2"):
        HandEyeFile.model_validate({"poses": named})
    called_by_number = [{**named[0], "name": "pose 2"}, {**named[0], "name": None}]
    with pytest.raises(ValueError, match="'pose 2' is given to 2"):
        HandEyeFile.model_validate({"poses": called_by_number})


@pytest.mark.parametrize("key", ["robot_sigma_mm", "robot_sigma_deg", "camera_sigma_px"])
@pytest.mark.parametrize("sigma", [0.0, -0.05])
def test_nothing_that_is_measured_has_no_uncertainty(key: str, sigma: float) -> None:
    with pytest.raises(ValueError, match=key):
        file(None, None, **{key: sigma})
