"""The settings of a contact from recipe and commissioning: without the run that carries it out, so
that `cellctl check` can judge them."""

import math

from cellctl.config.devices import ForceSensorConfig
from cellctl.config.driver_settings import sensor_rate_hz
from cellctl.force.contact.approach import planned_stiffness
from cellctl.force.contact.touch_detector import Cusum, touch_threshold_n
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings, PinSettings
from cellctl.processes.deck_to_frame.recipe import DeckRecipe, Mating, Pins

ABORT_MARGIN_N = 5.0
"""The guard stops the robot this much below the limit: for its filter and the arm's way to stop."""
RELEASE_BAND_N = 5.0
"""Relaxing ends within this distance of the recipe's release force: 10 to 20 N about 15 N."""


def mating_settings(
    sensor: ForceSensorConfig, recipe: DeckRecipe, commissioned: Commissioned, payload_kg: float
) -> MatingSettings:
    """The recipe's figures in SI; its bounds where nothing was commissioned."""
    mating = recipe.mating
    length_mm, width_mm = recipe.face_mm
    rate_hz = sensor_rate_hz(sensor)
    latency_s, stiffness_n_m = commissioned.stop_latency_s, mating.stiffness_n_per_mm / MM
    return MatingSettings(
        stop_latency_s=mating.stop_latency_ms / 1e3 if latency_s is None else latency_s,
        stiffness_n_m=planned_stiffness(
            stiffness_n_m, commissioned.stiffness_n_m, mating.part_spread_ratio
        ),
        moving_mass_kg=payload_kg,
        target_force_n=mating.target_force_n,
        limit_force_n=mating.limit_force_n,
        abort_force_n=mating.limit_force_n - ABORT_MARGIN_N,
        release_low_n=mating.release_force_n - RELEASE_BAND_N,
        release_high_n=mating.release_force_n + RELEASE_BAND_N,
        # The usual choice for the drift of a CUSUM is half of the shift that it has to find: less
        # would add up noise, more would be blind to a soft contact.
        touch=Cusum(mating.touch_force_n / 2, touch_threshold_n(rate_hz)),
        sample_period_s=1.0 / rate_hz,
        stale_s=sensor.stale_ms / 1e3,
        flange_age_s=sensor.flange_age_ms / 1e3,
        fast_speed_m_s=mating.fast_speed_mm_s * MM,
        acceleration_m_s2=mating.acceleration_mm_s2 * MM,
        greatest_past_m=mating.max_past_contact_mm * MM,
        window_m=mating.contact_window_mm * MM,
        travel_sigma_m=mating.travel_sigma_mm * MM,
        step_sigma_m=mating.step_sigma_mm * MM,
        thickness_sigma_m=recipe.deck_thickness_sigma_mm * MM,
        half_size_m=(length_mm / 2 * MM, width_mm / 2 * MM),
        plausible=(mating.max_untared_force_n, mating.max_untared_moment_n_m),
        max_lateral_n=mating.max_lateral_force_n,
        max_moment_n_m=mating.max_moment_n_m,
        pins=_pin_settings(mating, mating.pins) if mating.pins else None,
    )


def _pin_settings(mating: Mating, pins: Pins) -> PinSettings:
    lateral_n_per_mm = pins.lateral_stiffness_n_per_mm or mating.stiffness_n_per_mm
    searched = {}
    if pins.search is not None:
        searched = {
            "search_radius_m": pins.search.radius_mm * MM,
            "catch_m": pins.search.catch_mm * MM,
        }
    return PinSettings(
        **searched,
        engagement_m=pins.engagement_mm * MM,
        # The bound of the recipe, whatever procedure 108 has measured: it presses the seat, and
        # a seat may be far softer than the pins above it.
        stiffness_n_m=mating.stiffness_n_per_mm / MM,
        compliant=pins.compliance,
        greatest_travel_m=pins.max_travel_mm * MM,
        greatest_yaw_rad=math.radians(pins.max_yaw_deg),
        lateral_stiffness_n_m=lateral_n_per_mm / MM,
        yaw_stiffness_n_m_rad=pins.yaw_stiffness_n_m_per_deg / math.radians(1.0),
    )
