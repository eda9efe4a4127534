"""Stop latency and contact stiffness from measurements: straight lines and their uncertainty.

Both figures go into the approach speed as upper bounds, so their standard deviations matter as much
as the values.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.errors.force import CommissioningFailed
from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True)
class LatencyEstimate:
    """Overrun against speed: ``overrun = latency · v + offset``."""

    latency_s: float
    sigma_s: float
    offset_m: float
    residual_m: float
    """Root mean square of the overruns about the line."""

    @property
    def upper_s(self) -> float:
        """Upper bound for planning: three standard deviations above the estimate."""
        return self.latency_s + 3.0 * self.sigma_s


@dataclass(frozen=True, slots=True)
class StiffnessEstimate:
    """Force against travel after contact: ``F = k (s − s0)``."""

    stiffness_n_m: float
    sigma_n_m: float
    contact_m: float
    """Travel s0 at which the line meets zero force."""
    residual_n: float

    @property
    def upper_n_m(self) -> float:
        """Upper bound for planning: three standard deviations above the estimate."""
        return self.stiffness_n_m + 3.0 * self.sigma_n_m


def estimate_stop_latency(speeds_m_s: Array, overruns_m: Array) -> LatencyEstimate:
    """Latency from n ≥ 3 stops at different speeds.

    ``overruns_m`` is the path between the moment of the stop request and standstill. The slope is
    the latency; what does not depend on the speed, such as an offset of the readings, goes into
    the intercept. Raises ``CommissioningFailed`` when the speeds are too few or too alike, or the
    slope makes no sense.
    """
    # Two points always lie on a line, so a third one is needed to see how well it fits; and speeds
    # that are alike leave its slope to the noise.
    if len(speeds_m_s) < 3 or np.ptp(speeds_m_s) < 0.3 * np.max(speeds_m_s):
        raise CommissioningFailed(
            "latency needs three or more stops at speeds that differ by 30 % or more, got "
            + ", ".join(f"{speed * 1e3:.2f}" for speed in speeds_m_s)
            + " mm/s"
        )
    slope, offset, slope_sigma, rms = _line(speeds_m_s, overruns_m)
    # A latency this uncertain has an upper bound of more than twice its value: better no record
    # than one on which an approach is planned.
    if slope <= 0.0 or slope_sigma > 0.5 * slope:
        raise CommissioningFailed(
            f"overruns do not grow with speed: slope {slope * 1e3:.1f} ± {slope_sigma * 1e3:.1f} ms"
        )
    return LatencyEstimate(slope, slope_sigma, offset, rms)


def estimate_stiffness(
    travel_m: Array, force_n: Array, *, least_n: float = 5.0
) -> StiffnessEstimate:
    """Stiffness from standstill readings in contact, using those above ``least_n``.

    Raises ``CommissioningFailed`` when fewer than three readings are left or force falls.
    """
    # Just after touch only a part of the faces bears, so the first readings show too soft a
    # contact, and their noise is largest in proportion.
    used = force_n >= least_n
    if int(used.sum()) < 3 or np.ptp(travel_m[used]) <= 0.0:
        raise CommissioningFailed(
            f"stiffness needs three readings above {least_n:.1f} N at different travels, got "
            f"{int(used.sum())}"
        )
    slope, offset, slope_sigma, rms = _line(travel_m[used], force_n[used])
    if slope <= 0.0:
        raise CommissioningFailed(f"force does not grow with travel: {slope:.3g} N/m")
    return StiffnessEstimate(slope, slope_sigma, -offset / slope, rms)


def joint_stiffness(estimates: Sequence[StiffnessEstimate]) -> StiffnessEstimate:
    """One figure from n ≥ 2 contacts.

    No two contacts are equally stiff, so their scatter is added to the sigma of the fits.
    """
    slopes = np.array([estimate.stiffness_n_m for estimate in estimates])
    inner = np.mean([estimate.sigma_n_m**2 for estimate in estimates])
    return StiffnessEstimate(
        stiffness_n_m=float(slopes.mean()),
        # Two independent sources, so their variances add: how well each slope is known, and how
        # much the contacts differ.
        sigma_n_m=float(np.sqrt(inner + slopes.var(ddof=1))),
        contact_m=float(np.mean([estimate.contact_m for estimate in estimates])),
        residual_n=float(np.sqrt(np.mean([estimate.residual_n**2 for estimate in estimates]))),
    )


def _line(x: Array, y: Array) -> tuple[float, float, float, float]:
    """Least-squares line: slope, intercept, standard deviation of the slope, rms residual."""
    centred = x - x.mean()
    spread = float(centred @ centred)
    slope = float(centred @ y) / spread
    offset = float(y.mean()) - slope * float(x.mean())
    residual = y - slope * x - offset
    # Slope and intercept were taken from the same points, which therefore scatter less about this
    # line than about the true one.
    freedom = max(len(x) - 2, 1)
    sigma = float(np.sqrt(residual @ residual / freedom / spread))
    return slope, offset, sigma, float(np.sqrt(np.mean(residual**2)))
