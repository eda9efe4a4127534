"""A mating plan: every figure of one attempt, derived before anything moves."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.force import ContactPlanInvalid
from cellctl.force.contact.approach import (
    ApproachFigures,
    ApproachSpeed,
    ContactWindow,
    advance,
    approach_speed,
    contact_sigma,
    contact_window,
    segment_length,
)
from cellctl.force.contact.compliance import NO_OFFSET, ComplianceLaw, LateralOffset
from cellctl.force.contact.creep import CreepLaw
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings

READING_BAND_N = 1.2
"""How far above F_t the creep ends, four standard deviations of a reading: noise must not decide
whether the force of a seat was reached."""
NOISE_BAND_N = 2.0
"""How far the filtered force swings about its mean: a mean of 43 N may read 45 N for a moment
(docs/mating.md, "The creep"). The creep keeps that far from the abort limit."""


@dataclass(frozen=True, slots=True)
class MatingPlan:
    """One attempt, from the stand-off to the seat."""

    base_T_flange: RigidTransform
    """The stand-off, where the robot must be standing."""
    flange_T_deck: RigidTransform
    flange_T_sensor: RigidTransform
    settings: MatingSettings
    window: ContactWindow
    speed: ApproachSpeed
    segment_m: float
    """Longest single move of the slow travel: bounded force even if a stop is never obeyed."""
    creep: CreepLaw
    release: CreepLaw
    compliance: ComplianceLaw | None
    """How the deck gives way to pins; None where it does not."""

    def pose_at(self, travel_m: float, offset: LateralOffset = NO_OFFSET) -> RigidTransform:
        """Flange after ``travel_m`` along −Z_D (eq. 18), shifted by ``offset`` where the deck gave
        way."""
        return advance(self.base_T_flange, self.flange_T_deck, travel_m, offset)

    def travel_of(self, base_T_flange: RigidTransform) -> float:
        """Travel along −Z_D (m) of a reported pose."""
        along = (self.base_T_flange * self.flange_T_deck).rotation.apply([0.0, 0.0, -1.0])
        moved = base_T_flange.translation - self.base_T_flange.translation
        return float(moved @ along)

    @property
    def end_of_travel_m(self) -> float:
        """Travel (m) beyond which no target is commanded."""
        return self.window.expected_m + self.settings.greatest_past_m


def plan_mating(
    *,
    base_T_flange: RigidTransform,
    flange_T_deck: RigidTransform,
    flange_T_sensor: RigidTransform,
    M_T_D: UncertainPose,
    deck_thickness_m: float,
    over_travel_m: float,
    settings: MatingSettings,
) -> MatingPlan:
    """Derive window, speed, segment and creep from the measured deck pose at the stand-off.

    ``deck_thickness_m`` is D1 (contact when Z_D reaches it), ``over_travel_m`` D3, the hard end.
    Raises ``ContactPlanInvalid``.
    """
    window = _window(M_T_D, deck_thickness_m, settings)
    if settings.abort_force_n >= settings.limit_force_n:
        raise ContactPlanInvalid(
            f"the guard would stop at {settings.abort_force_n:.0f} N, at or above the limit of "
            f"{settings.limit_force_n:.0f} N"
        )
    # D3 is the hard end of travel in the paper (eq. 17); here it only bounds the recipe, because
    # nobody commands a pose 25 mm past contact (docs/mating.md, "The commanded target").
    if settings.greatest_past_m > over_travel_m:
        raise ContactPlanInvalid("targets may not lie further past contact than D3")
    figures = ApproachFigures(
        stop_latency_s=settings.stop_latency_s,
        stiffness_n_m=settings.approach_stiffness_n_m,
        contact_stiffness_n_m=settings.approach_contact_stiffness_n_m,
        moving_mass_kg=settings.moving_mass_kg,
        deceleration_m_s2=settings.deceleration_m_s2,
        stale_s=settings.stale_s,
        filter_delay_s=settings.filter_delay_s,
        sample_period_s=settings.sample_period_s,
        touch=settings.touch,
        tare_uncertainty_n=settings.tare_uncertainty_n,
        step_sigma_m=settings.step_sigma_m,
    )
    # Against the guard's limit and not the allowed peak: a robot that obeys no stop runs the whole
    # segment.
    segment_m = segment_length(figures, limit_n=settings.abort_force_n)
    return MatingPlan(
        base_T_flange=base_T_flange,
        flange_T_deck=flange_T_deck,
        flange_T_sensor=flange_T_sensor,
        settings=settings,
        window=window,
        speed=approach_speed(figures, allowed_peak_n=settings.touch_peak_n),
        segment_m=min(segment_m, settings.greatest_segment_m),
        creep=_creep(settings),
        release=_release(settings),
        compliance=_compliance(settings),
    )


def _window(
    M_T_D: UncertainPose, deck_thickness_m: float, settings: MatingSettings
) -> ContactWindow:
    half_x, half_y = settings.half_size_m
    sigma = M_T_D.sigma
    # The tilt about x lifts the edges along y, hence the crossed indices (docs/mating.md, formula
    # of sigma).
    sigma_m = contact_sigma(
        sigma[2],
        settings.thickness_sigma_m,
        settings.travel_sigma_m,
        half_x * sigma[4],
        half_y * sigma[3],
    )
    rx, ry, _ = np.abs(M_T_D.pose.rotation.as_rotvec())
    return contact_window(
        float(M_T_D.pose.translation[2]) - deck_thickness_m,
        sigma_m=sigma_m,
        coverage=settings.coverage,
        least_half_m=settings.least_window_m,
        greatest_half_m=min(settings.window_m, settings.greatest_past_m),
        # The lower edge of a tilted deck touches this much sooner.
        tilt_m=float(half_x * ry + half_y * rx),
        margin_m=settings.clear_margin_m,
        engaged_m=settings.pins.engagement_m if settings.pins else 0.0,
    )


def _creep(settings: MatingSettings) -> CreepLaw:
    low = settings.target_force_n + READING_BAND_N
    # One band below the bound that no step may pass (``abort_n`` in ``_law``), so that the creep
    # ends before it gets there.
    high = settings.abort_force_n - 2.0 * NOISE_BAND_N
    if high - low < NOISE_BAND_N:
        raise ContactPlanInvalid(
            f"target {settings.target_force_n:.0f} N and abort {settings.abort_force_n:.0f} N "
            "leave no window for the final force"
        )
    return _law(settings, low, high)


def _release(settings: MatingSettings) -> CreepLaw:
    # A quarter from each side leaves at least half of the window, however narrow a recipe makes it.
    band = min(NOISE_BAND_N, (settings.release_high_n - settings.release_low_n) / 4.0)
    return _law(settings, settings.release_low_n + band, settings.release_high_n - band)


def _compliance(settings: MatingSettings) -> ComplianceLaw | None:
    pins = settings.pins
    if pins is None or not pins.compliant:
        return None
    return ComplianceLaw(
        stiffness_n_m=pins.lateral_stiffness_n_m,
        yaw_stiffness_n_m_rad=pins.yaw_stiffness_n_m_rad,
        damping_n_s_m=settings.creep_damping_n_s_m,
        period_s=settings.step_period_s,
        dead_band_n=pins.dead_band_n,
        dead_band_n_m=pins.dead_band_n_m,
        greatest_step_m=pins.greatest_step_m,
        greatest_step_rad=pins.greatest_step_rad,
        greatest_travel_m=pins.greatest_travel_m,
        greatest_yaw_rad=pins.greatest_yaw_rad,
    )


def _law(settings: MatingSettings, low_n: float, high_n: float) -> CreepLaw:
    return CreepLaw(
        reference_n=(low_n + high_n) / 2.0,
        done_low_n=low_n,
        done_high_n=high_n,
        damping_n_s_m=settings.creep_damping_n_s_m,
        mass_kg=settings.creep_mass_kg,
        period_s=settings.step_period_s,
        stiffness_n_m=settings.stiffness_n_m,
        greatest_step_m=settings.greatest_step_m,
        smallest_step_m=settings.smallest_step_m,
        force_sigma_n=settings.force_sigma_n,
        # A mean at this force may read the guard's limit for a moment.
        abort_n=settings.abort_force_n - NOISE_BAND_N,
        step_sigma_m=settings.step_sigma_m,
    )
