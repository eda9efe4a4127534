"""The force curve of a contact and the figures that describe it."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array

FINAL_S = 0.5
"""Stretch at the end of a curve that stands for the seated part."""


@dataclass(frozen=True, slots=True, eq=False)
class ForceCurve:
    """Force and moment over time, as the guard recorded them."""

    time_s: Array
    """Shape (n,), monotonic."""
    wrench: Array
    """Shape (n, 6): gravity compensated and tared, about the origin and in the axes of the guard's
    wrench frame."""
    travel_m: Array
    """Shape (n,): travel along the approach from the stand-off; NaN where it is not known."""


@dataclass(frozen=True, slots=True, eq=False)
class CurveStatistics:
    """Figures of one curve, in N and N·m, signs as the guard has them."""

    samples: int
    duration_s: float
    rate_hz: float
    peak_fz_n: float
    peak_filtered_fz_n: float
    peak_lateral_n: float
    peak_moment_n_m: float
    final: Array
    """Shape (6,): mean over the last ``FINAL_S``."""
    final_sigma: Array
    """Shape (6,): standard deviation of the samples there."""


def curve_statistics(
    time_s: Array, wrench: Array, *, filter_s: float = 5e-3, final_s: float = FINAL_S
) -> CurveStatistics:
    """Statistics of n ≥ 2 samples, ``wrench`` of shape (n, 6); ``ValueError`` for other shapes.

    ``filter_s`` is the window of the mean for the filtered peak. It is the time constant of the
    guard's low-pass, so that the record shows about what the guard compared with its limit.
    ``final_s`` is the stretch at the end that stands for the seated part.
    """
    if len(time_s) < 2 or wrench.shape != (len(time_s), 6):
        raise ValueError("a curve needs at least two samples and six components")
    duration_s = float(time_s[-1] - time_s[0])
    force_n = wrench[:, 2]
    filtered = moving_average(force_n, max(1, round(filter_s * (len(time_s) - 1) / duration_s)))
    tail = wrench[time_s >= time_s[-1] - final_s]
    return CurveStatistics(
        samples=len(time_s),
        duration_s=duration_s,
        rate_hz=(len(time_s) - 1) / duration_s,
        peak_fz_n=float(force_n.max()),
        peak_filtered_fz_n=float(filtered.max()),
        peak_lateral_n=float(np.hypot(wrench[:, 0], wrench[:, 1]).max()),
        peak_moment_n_m=float(np.linalg.norm(wrench[:, 3:], axis=1).max()),
        final=tail.mean(axis=0),
        final_sigma=tail.std(axis=0),
    )


def moving_average(signal: Array, samples: int) -> Array:
    """Mean of the last ``samples`` values, of fewer at the start; shape as given, (n,)."""
    # Differences of a cumulative sum make the mean independent of the window's length: curves have
    # tens of thousands of samples.
    total = np.concatenate([[0.0], np.cumsum(signal)])
    end = np.arange(1, len(signal) + 1)
    begin = np.maximum(end - samples, 0)
    return np.asarray((total[end] - total[begin]) / (end - begin))
