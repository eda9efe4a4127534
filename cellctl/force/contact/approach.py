"""How fast, from where and how far to move towards a contact: all derived, nothing guessed.

Force grows with ``k·v`` once deck and frame touch. Until the arm stands, that is ``T`` later, it
grows by ``k·v·T``; the speed follows from how much growth the limits leave.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.errors.force import MatingPlanInvalid
from cellctl.force.contact.compliance import STRAIGHT, LateralOffset
from cellctl.force.contact.cusum import Cusum


@dataclass(frozen=True, slots=True)
class ApproachFigures:
    """What the speed depends on: measured at commissioning or stated by the recipe."""

    stop_latency_s: float
    """From the stop request on the wire to standstill at low speed, upper bound."""
    stiffness_n_m: float
    """Arm and contact in series, along the approach: what force grows with when the arm moves on;
    upper bound."""
    contact_stiffness_n_m: float
    """Deck on frame alone, upper bound: what an impact meets."""
    moving_mass_kg: float
    """What hangs behind the arm's compliance and meets the contact."""
    deceleration_m_s2: float
    stale_s: float
    """Age of a sample at which the guard stops: the worst delay of a reading."""
    filter_delay_s: float
    """Delay of detector input behind the true force beyond the detector's own."""
    sample_period_s: float
    touch: Cusum
    tare_uncertainty_n: float
    """What tare, drift and pose may leave on the force reading."""
    step_sigma_m: float
    """Standard deviation of the length of a single move."""

    @property
    def delay_s(self) -> float:
        """From a force at the contact to standstill, without the detector's own delay."""
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


def series(first_n_m: float, second_n_m: float) -> float:
    """Stiffness of two springs in series."""
    return first_n_m * second_n_m / (first_n_m + second_n_m)


def planned_stiffness(
    bound_n_m: float, measured_upper_n_m: float | None, part_spread_ratio: float
) -> float:
    """Stiffness to plan with, arm and contact in series, as an upper bound.

    What one pair of parts has shown counts for the next one ``part_spread_ratio`` times stiffer,
    and never above the bound that holds without any measurement.
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
    impact_n = speed_m_s * float(np.sqrt(figures.contact_stiffness_n_m * figures.moving_mass_kg))
    tare_n = figures.tare_uncertainty_n
    peak_n = touch_n + latency_n + ramp_n + impact_n + tare_n
    return ApproachSpeed(speed_m_s, peak_n, touch_n, latency_n, ramp_n, impact_n, tare_n, figures)


def approach_speed(
    figures: ApproachFigures, *, allowed_peak_n: float, greatest_m_s: float = 1e-3
) -> ApproachSpeed:
    """The greatest speed whose predicted peak stays below ``allowed_peak_n``.

    Raises ``MatingPlanInvalid`` when even the slowest approach would exceed it.
    """
    slowest = 1e-7
    if peak_at(slowest, figures).peak_n >= allowed_peak_n:
        raise MatingPlanInvalid(
            f"no approach speed keeps the peak below {allowed_peak_n:.1f} N: touch threshold and "
            f"tare alone take {peak_at(slowest, figures).peak_n:.1f} N"
        )
    if peak_at(greatest_m_s, figures).peak_n <= allowed_peak_n:
        return peak_at(greatest_m_s, figures)
    speed = brentq(
        lambda v: peak_at(v, figures).peak_n - allowed_peak_n, slowest, greatest_m_s, rtol=1e-6
    )
    return peak_at(float(speed), figures)


def segment_length(figures: ApproachFigures, *, limit_n: float) -> float:
    """Longest single move (m) that cannot exceed ``limit_n`` even if no stop is ever obeyed.

    Each move starts below the detector's drift level, so it adds no more than k times its length,
    and the arm's own error of the move.
    """
    spare_n = limit_n - figures.touch.drift_n - figures.tare_uncertainty_n
    length_m = spare_n / figures.stiffness_n_m - 3.0 * figures.step_sigma_m
    if length_m <= figures.step_sigma_m:
        raise MatingPlanInvalid(
            f"a single move cannot be kept below {limit_n:.1f} N: stiffness "
            f"{figures.stiffness_n_m / 1e3:.0f} N/mm, error of a move "
            f"{figures.step_sigma_m * 1e6:.1f} µm"
        )
    return length_m


@dataclass(frozen=True, slots=True)
class ContactWindow:
    """Where contact is expected, as travel from the stand-off along the approach (m)."""

    expected_m: float
    earliest_m: float
    latest_m: float
    """Also the greatest travel that may be commanded before contact."""
    clear_m: float
    """Travel up to which contact is excluded: fast motion ends here."""


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

    ``sigma_m`` joins all sources (see ``contact_sigma``); ``tilt_m`` is how much earlier the
    leading edge touches; ``margin_m`` is kept between fast travel and window; pins are met
    ``engaged_m`` before the seat, and fast travel ends above them. Raises ``MatingPlanInvalid``
    when contact is known too badly or too near.
    """
    half_m = max(coverage * sigma_m, least_half_m)
    if half_m > greatest_half_m:
        raise MatingPlanInvalid(
            f"contact is known to ±{half_m * 1e3:.3f} mm only ({coverage:g} sigma), the window "
            f"may be ±{greatest_half_m * 1e3:.3f} mm wide at most"
        )
    earliest_m = expected_m - half_m - tilt_m
    clear_m = earliest_m - engaged_m - margin_m
    if clear_m <= 0.0:
        raise MatingPlanInvalid(
            f"expected contact after {expected_m * 1e3:.3f} mm leaves no clear travel before its "
            f"window of ±{half_m * 1e3:.3f} mm"
        )
    return ContactWindow(expected_m, earliest_m, expected_m + half_m, clear_m)


def contact_sigma(*sigmas_m: float) -> float:
    """Independent standard deviations of the contact position joined (m)."""
    return float(np.sqrt(sum(sigma**2 for sigma in sigmas_m)))


def advance(
    base_T_flange: RigidTransform,
    flange_T_deck: RigidTransform,
    travel_m: float,
    sideways: LateralOffset = STRAIGHT,
) -> RigidTransform:
    """The flange after the deck has moved by ``travel_m`` along −Z_D, and sideways.

    Eq. 18 from the present pose: needs no camera in the chain, so the travel is as good as the
    arm's relative accuracy.
    """
    moved = RigidTransform.from_components(
        [sideways.x_m, sideways.y_m, -travel_m], Rotation.from_rotvec([0.0, 0.0, sideways.yaw_rad])
    )
    return base_T_flange * flange_T_deck * moved * flange_T_deck.inv()
