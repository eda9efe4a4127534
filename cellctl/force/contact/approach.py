"""Speed, start and length of the moves towards a contact, derived from the figures of arm and part.

Once two parts touch, the force between them grows at the rate ``k·v``. Until the arm stands, a time
``T`` later, it has grown by ``k·v·T``. So the greatest speed follows from how much growth the force
limit leaves, and the fast travel has to end before the earliest position at which the parts can
touch.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.errors.force import ContactPlanInvalid
from cellctl.force.contact.compliance import NO_OFFSET, LateralOffset
from cellctl.force.contact.touch_detector import Cusum

_SPEED_RATIO = 1e-6
"""Of the speed, within which the greatest one is found."""


@dataclass(frozen=True, slots=True)
class ApproachFigures:
    """The figures that decide the speed: measured at commissioning, or stated by the recipe."""

    stop_latency_s: float
    """Upper bound of the time from the stop request on the wire to standstill at low speed."""
    stiffness_n_m: float
    """Upper bound of arm and contact in series, along the approach: the force grows by this much
    for each metre that the arm moves on."""
    contact_stiffness_n_m: float
    """Upper bound of the contact alone, without the arm: this is what an impact meets, because the
    mass in front of the arm's compliance moves on by itself."""
    moving_mass_kg: float
    """The mass that hangs on the arm's compliance and meets the contact."""
    deceleration_m_s2: float
    stale_s: float
    """Age of a sample at which the guard stops: the worst delay of a reading."""
    filter_delay_s: float
    """Lag of the detector's input behind the true force."""
    sample_period_s: float
    touch: Cusum
    tare_uncertainty_n: float
    """Error of the force reading that tare, drift and pose may leave."""
    step_sigma_m: float
    """Standard deviation of the length of a single move."""

    @property
    def delay_s(self) -> float:
        """Time from a force at the contact to standstill, without the detector's own delay."""
        return self.stop_latency_s + self.stale_s + self.filter_delay_s


@dataclass(frozen=True, slots=True)
class ApproachSpeed:
    """The speed and every term of the formula at that speed, for the record."""

    speed_m_s: float
    peak_n: float
    """Predicted worst peak: the sum of the terms below."""
    touch_n: float
    """Force when the detector alarms."""
    latency_n: float
    """k·v·T while the stop is under way."""
    ramp_n: float
    """k·v²/2a while the arm slows down."""
    impact_n: float
    """v·sqrt(k_c·m), the moving mass against the contact."""
    tare_n: float
    figures: ApproachFigures

    FORMULA = "F_peak = h(k v) + k v T + k v^2/(2 a) + v sqrt(k_c m) + F_tare"


def planned_stiffness(
    bound_n_m: float, measured_upper_n_m: float | None, part_spread_ratio: float
) -> float:
    """Stiffness of arm and contact in series to plan with, an upper bound.

    The next pair of parts may be ``part_spread_ratio`` times as stiff as the one that was measured,
    but never stiffer than the bound that holds without any measurement.
    """
    if measured_upper_n_m is None:
        return bound_n_m
    return min(bound_n_m, part_spread_ratio * measured_upper_n_m)


def peak_at(speed_m_s: float, figures: ApproachFigures) -> ApproachSpeed:
    """Predicted worst peak of the contact force when touched at a speed."""
    stiffness = figures.stiffness_n_m
    touch_n = figures.touch.force_at_alarm(stiffness * speed_m_s, figures.sample_period_s)
    latency_n = stiffness * speed_m_s * figures.delay_s
    ramp_n = stiffness * speed_m_s**2 / (2.0 * figures.deceleration_m_s2)
    # The impact of a mass on a spring. The stiffness of the contact alone counts: in these
    # milliseconds the mass moves on without the arm, whose compliance lies behind it.
    impact_n = speed_m_s * float(np.sqrt(figures.contact_stiffness_n_m * figures.moving_mass_kg))
    tare_n = figures.tare_uncertainty_n
    # The terms do not all peak at the same moment. Their plain sum is an upper bound, and the plan
    # needs one.
    peak_n = touch_n + latency_n + ramp_n + impact_n + tare_n
    return ApproachSpeed(speed_m_s, peak_n, touch_n, latency_n, ramp_n, impact_n, tare_n, figures)


def approach_speed(
    figures: ApproachFigures, *, allowed_peak_n: float, greatest_m_s: float = 1e-3
) -> ApproachSpeed:
    """The greatest speed up to ``greatest_m_s`` whose predicted peak is within ``allowed_peak_n``.

    Raises ``ContactPlanInvalid`` when even the slowest approach would exceed it.
    """
    # At this speed only the terms are left that do not depend on it.
    slowest_m_s = 1e-7
    least_n = peak_at(slowest_m_s, figures).peak_n
    if least_n >= allowed_peak_n:
        raise ContactPlanInvalid(
            f"no approach speed keeps the peak below {allowed_peak_n:.1f} N: touch threshold and "
            f"tare alone take {least_n:.1f} N"
        )
    if peak_at(greatest_m_s, figures).peak_n <= allowed_peak_n:
        return peak_at(greatest_m_s, figures)
    # Halved by hand, which takes some thirty peaks: the root finders of scipy take longer to load
    # than all else of a check, and the side of the limit that one of them ends on is left to it.
    slower_m_s, faster_m_s = slowest_m_s, greatest_m_s
    while faster_m_s - slower_m_s > _SPEED_RATIO * faster_m_s:
        middle_m_s = (slower_m_s + faster_m_s) / 2.0
        if peak_at(middle_m_s, figures).peak_n <= allowed_peak_n:
            slower_m_s = middle_m_s
        else:
            faster_m_s = middle_m_s
    return peak_at(slower_m_s, figures)


def segment_length(figures: ApproachFigures, *, limit_n: float) -> float:
    """Longest single move (m) that keeps the force below ``limit_n`` even if no stop is obeyed.

    A move begins at a force below the detector's drift level, or the detector would have alarmed
    before. It adds no more than the stiffness times its length and the arm's own error of a move.
    Raises ``ContactPlanInvalid`` when no move can be that short.
    """
    # This bound uses neither the latency nor the detector, so it also holds when no stop is obeyed
    # at all: a robot link with dead times makes the travel slow anyway, and short moves cost little
    # there.
    spare_n = limit_n - figures.touch.drift_n - figures.tare_uncertainty_n
    length_m = spare_n / figures.stiffness_n_m - 3.0 * figures.step_sigma_m
    # A move that is no longer than its own error may as well stand still or go back.
    if length_m <= figures.step_sigma_m:
        raise ContactPlanInvalid(
            f"a single move cannot be kept below {limit_n:.1f} N: stiffness "
            f"{figures.stiffness_n_m / 1e3:.0f} N/mm, error of a move "
            f"{figures.step_sigma_m * 1e6:.1f} µm"
        )
    return length_m


@dataclass(frozen=True, slots=True)
class ContactWindow:
    """The expected place of contact, as travel from the stand-off along the approach (m)."""

    expected_m: float
    earliest_m: float
    latest_m: float
    """Also the greatest travel that may be commanded before contact."""
    clear_m: float
    """Travel up to which contact is impossible: fast motion ends here."""


def contact_window(
    expected_m: float,
    *,
    sigma_m: float,
    coverage: float,
    least_half_m: float,
    greatest_half_m: float,
    tilt_m: float,
    margin_m: float,
    engaged_m: float = 0.0,
) -> ContactWindow:
    """Window of ±coverage·sigma around the expected contact of the middle of the face.

    ``sigma_m`` joins all sources of error (see ``contact_sigma``). ``tilt_m`` is how much earlier
    the leading edge of a tilted part touches. ``margin_m`` is kept between the fast travel and the
    window. Pins are met ``engaged_m`` before the seat, and the fast travel ends above them. Raises
    ``ContactPlanInvalid`` when the contact is known too badly, or is too near.
    """
    # Not narrower than ``least_half_m``: a covariance that is too small must not turn a good
    # contact into a fault.
    half_m = max(coverage * sigma_m, least_half_m)
    if half_m > greatest_half_m:
        raise ContactPlanInvalid(
            f"contact is known to ±{half_m * 1e3:.3f} mm only ({coverage:g} sigma), the window "
            f"may be ±{greatest_half_m * 1e3:.3f} mm wide at most"
        )
    earliest_m = expected_m - half_m - tilt_m
    clear_m = earliest_m - engaged_m - margin_m
    # Fast travel may not end inside the window, because at its speed a contact goes past the force
    # limit.
    if clear_m <= 0.0:
        raise ContactPlanInvalid(
            f"expected contact after {expected_m * 1e3:.3f} mm leaves no clear travel before its "
            f"window of ±{half_m * 1e3:.3f} mm"
        )
    return ContactWindow(expected_m, earliest_m, expected_m + half_m, clear_m)


def contact_sigma(*sigmas_m: float) -> float:
    """Standard deviation (m) of the contact position from several independent sources."""
    return float(np.sqrt(sum(sigma**2 for sigma in sigmas_m)))


def advance(
    base_T_flange: RigidTransform,
    flange_T_part: RigidTransform,
    travel_m: float,
    offset: LateralOffset = NO_OFFSET,
) -> RigidTransform:
    """The flange after the part has moved by ``travel_m`` along its −z axis, and by ``offset``.

    Paper eq. 18, from the present pose. No camera takes part in it, so the travel is as good as the
    relative accuracy of the arm, which is far better than its absolute one.
    """
    moved = RigidTransform.from_components(
        [offset.x_m, offset.y_m, -travel_m], Rotation.from_rotvec([0.0, 0.0, offset.yaw_rad])
    )
    return base_T_flange * flange_T_part * moved * flange_T_part.inv()
