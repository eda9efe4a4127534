"""The analogue side of the fake box: a wrench becomes bridge signals, bridge signals become counts.

The matrix is made up; no data of the M4347K are public. Its size is such that the end of scale
(amplifier at its rails) lies near 7.9 kN for forces and 790 N·m for moments.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

# Replies of boxes in public code show about 5.0067 V, 123.691486 and 32775 for a channel; what the
# other channels differ by is made up. Since they differ, a mix-up of channels shows.
EXCITATION_V = np.array([5.0067, 5.0067, 5.0071, 5.0064, 5.0069, 5.0066])
GAIN = np.array([123.691486, 123.702110, 123.688953, 123.710006, 123.695720, 123.699081])
ZERO_COUNTS = np.array([32775.0, 32761.0, 32790.0, 32744.0, 32770.0, 32782.0])

_FORCE_PER_MV_V = 2000.0
_MOMENT_PER_MV_V = 200.0
_CROSS_TALK = np.array(
    [
        [1.000, 0.008, -0.004, 0.002, 0.011, -0.003],
        [-0.006, 1.000, 0.005, -0.010, 0.003, 0.004],
        [0.003, -0.005, 1.000, 0.004, -0.002, 0.001],
        [0.004, -0.012, 0.003, 1.000, 0.006, -0.005],
        [0.010, 0.002, -0.004, -0.005, 1.000, 0.007],
        [-0.002, 0.003, 0.006, 0.004, -0.008, 1.000],
    ]
)
FACTORY_MATRIX = np.diag([_FORCE_PER_MV_V] * 3 + [_MOMENT_PER_MV_V] * 3) @ _CROSS_TALK
"""Rows Fx … Mz in N and N·m, columns the six bridges in mV/V."""

# A converter of 16 bits over 5 V behind the amplifier; signals are in mV for each V of excitation.
# A count is then 1.23e-4 mV/V, and half of the scale 4 mV/V.
_COUNTS_PER_MV_V = 65535.0 / 5.0 / 1000.0 * GAIN * EXCITATION_V
_LOWEST_MV_V = -ZERO_COUNTS / _COUNTS_PER_MV_V
_HIGHEST_MV_V = (65535.0 - ZERO_COUNTS) / _COUNTS_PER_MV_V


class Transducer:
    """Bridges and converter under a source of true wrenches."""

    def __init__(self, sample: Callable[[float], Sequence[float]]) -> None:
        self._sample = sample
        self._to_bridge = np.linalg.inv(FACTORY_MATRIX)
        self._zero = np.zeros(6)

    def bridge_mv_v(self, time_s: float) -> Vector:
        """Bridge signals at a time, clipped where the amplifier clips."""
        wrench = np.asarray(self._sample(time_s), dtype=float)
        if wrench.shape != (6,):
            raise ValueError(f"a sample is six numbers, got shape {wrench.shape}")
        signal = self._to_bridge @ wrench
        return np.asarray(np.clip(signal, _LOWEST_MV_V, _HIGHEST_MV_V) - self._zero)

    @property
    def end_of_scale_mv_v(self) -> Vector:
        """What all bridges read when their amplifiers are at the upper rail."""
        return np.asarray(_HIGHEST_MV_V - self._zero)

    def adjust_zero(self, channels: Sequence[bool], time_s: float) -> None:
        """ADJZF: make the present signal of the flagged channels read zero."""
        self._zero = self._zero + np.where(channels, self.bridge_mv_v(time_s), 0.0)


def counts(bridge_mv_v: Vector) -> Vector:
    """Converter counts of bridge signals, not yet rounded."""
    return np.asarray(ZERO_COUNTS + bridge_mv_v * _COUNTS_PER_MV_V)


def engineering(bridge_mv_v: Vector, matrix: Vector, raw_unit: str) -> Vector:
    """Forces and moments that the box computes with its matrix."""
    signal = bridge_mv_v * EXCITATION_V if raw_unit == "MV" else bridge_mv_v
    return np.asarray(matrix @ signal)
