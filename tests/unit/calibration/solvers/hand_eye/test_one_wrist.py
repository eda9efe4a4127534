import numpy as np
import pytest

from cellctl.calibration.solvers.hand_eye.one_wrist import require_one_wrist
from cellctl.errors.calibration import WristConfigurationsDiffer

ELBOW_UP = np.radians([0, -70, 110, 0, 50, 0])
FLIPPED = np.radians([0, -70, 110, 180, -50, 180])


def test_poses_folded_alike_are_fine() -> None:
    require_one_wrist({"a": ELBOW_UP, "b": ELBOW_UP + 0.1})


def test_the_poses_folded_otherwise_are_named() -> None:
    with pytest.raises(WristConfigurationsDiffer, match="in c"):
        require_one_wrist({"a": ELBOW_UP, "b": ELBOW_UP, "c": FLIPPED})


def test_a_file_without_joints_says_nothing() -> None:
    require_one_wrist({})
