"""Planes that lie higher or lower than they are said to.

Marks are measured although the height is a little wrong, contacts only where it is as stated.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.processes.antenna_module.faults.connector import PlaneScaleWrong
from cellctl.processes.antenna_module.vision.measure import measure_connector, measure_marks
from tests.rigs.antenna.pictures import CLEAN, Conditions, trial
from tests.rigs.sweeps import sweep

HEIGHT_SIGMA_M = 0.2e-3


@pytest.mark.parametrize("wrong_m", sweep((-0.4e-3, 0.0, 0.4e-3), (0.4e-3,)))
def test_marks_are_found_within_what_is_stated_of_the_height(wrong_m: float) -> None:
    given = trial(1, Conditions(marks=True, um_per_px=(35.0, 35.0), height_sigma_m=HEIGHT_SIGMA_M))
    assert given.marks is not None
    exact = measure_marks(given.pixels.plane, given.camera, given.plane, given.marks)
    lifted = RigidTransform.from_translation([0.0, 0.0, wrong_m])
    plane = replace(given.plane, camera_T_plane=given.plane.camera_T_plane * lifted)
    found = measure_marks(given.pixels.plane, given.camera, plane, given.marks)
    moved = found.camera_T_marks.pose.translation - exact.camera_T_marks.pose.translation
    assert moved[2] == pytest.approx(-wrong_m, abs=1e-6)
    # The marks' middle is 5 mm beside their origin, and the camera's axis 2 mm at most.
    assert np.linalg.norm(moved[:2]) < 7e-3 * abs(wrong_m) / 0.25 + 1e-6


@pytest.mark.parametrize("wrong_m", sweep((-2e-3, 2e-3), (2e-3,)))
def test_contacts_that_look_too_large_or_too_small_for_their_plane_are_refused(
    wrong_m: float,
) -> None:
    given = trial(1, CLEAN)
    lifted = RigidTransform.from_translation([0.0, 0.0, wrong_m])
    plane = replace(given.plane, camera_T_plane=lifted * given.plane.camera_T_plane)
    with pytest.raises(PlaneScaleWrong) as raised:
        measure_connector(given.pixels.plane, given.camera, plane, given.connector)
    # What is said to lie farther from the camera than it does looks as if it were nearer.
    said = re.search(r"plane were ([+-][\d.]+) mm", raised.value.detail)
    assert said is not None
    assert float(said[1]) == pytest.approx(-wrong_m * 1e3, abs=0.3)
