"""What is left out or kept ready for speed gives the same numbers."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fakes.scenes.socket.peaks import WINDOWS_MS, ForcePeaks
from fakes.world.peg.attitude import axis_of
from fakes.world.peg.face import cone_point

SHIFT_M = st.floats(-1e-3, 1e-3)
TILT_RAD = st.floats(-0.2, 0.2)


@given(SHIFT_M, SHIFT_M, TILT_RAD, TILT_RAD, st.sampled_from([(2.5e-3, 0.0), (3e-3, 0.5e-3)]))
def test_a_ring_that_cannot_reach_the_cone_never_does(
    x_m: float, y_m: float, tilt_x: float, tilt_y: float, ring: tuple[float, float]
) -> None:
    """The bound by which ``Slots`` leaves a ring out."""
    radius_m, up_m = ring
    axis = axis_of(tilt_x, tilt_y)
    *_, rho_m = cone_point((x_m, y_m, -1e-3), axis, radius_m, up_m)
    centre_m = math.hypot(x_m + up_m * axis[0], y_m + up_m * axis[1])
    assert rho_m <= (centre_m + radius_m) * (1 + 1e-12)


@pytest.mark.parametrize("at_once", [1, 8, 16, 200])
def test_peaks_are_those_of_the_means_of_all_samples(at_once: int) -> None:
    wrenches = np.random.default_rng(1).normal(0.0, 5.0, (200, 6))
    wrenches[80:130] = 0.0
    peaks = ForcePeaks()
    for begin in range(0, len(wrenches), at_once):
        peaks.take(wrenches[begin : begin + at_once])
    before = np.zeros((max(WINDOWS_MS), 6))
    padded = np.concatenate([before, wrenches])
    for window in WINDOWS_MS:
        means = [
            padded[end - window : end].sum(axis=0) / window
            for end in range(len(before) + 1, len(padded) + 1)
        ]
        most_n, most_n_m = (
            max(float(np.linalg.norm(m[part])) for m in means) for part in (slice(3), slice(3, 6))
        )
        assert peaks.force_n[window] == pytest.approx(most_n, rel=1e-12)
        assert peaks.moment_n_m[window] == pytest.approx(most_n_m, rel=1e-12)
