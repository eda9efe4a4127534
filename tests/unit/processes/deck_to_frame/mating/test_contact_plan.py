"""What a contact is planned with: the recipe's bounds, or what commissioning has measured."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from cellctl.config.devices import ForceSensorConfig
from cellctl.errors.calibration import HeadPoseChanged
from cellctl.errors.robot import SpeedOverridden
from cellctl.force.contact.touch_detector import Cusum, touch_threshold_n
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.mating.contact_plan import contact_plan
from cellctl.processes.deck_to_frame.mating.limits import contact_limits
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.planned_settings import mating_settings
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings
from cellctl.processes.deck_to_frame.recipe import Pins, PinSearch
from cellctl.processes.deck_to_frame.run_facts import read_facts
from cellctl.processes.deck_to_frame.steps.correct_pose import correct_pose
from tests.unit.processes.deck_to_frame.rig import RunRig
from tests.unit.processes.deck_to_frame.steps.test_steps import at_the_stand_off


async def plan_of(rig: RunRig, commissioned: Commissioned) -> MatingPlan:
    return contact_plan(await correct_pose(await at_the_stand_off(rig)), commissioned)


def settings_of(rig: RunRig, payload_kg: float = 200.0, **recipe: Any) -> MatingSettings:
    """Settings of the shipped recipe with changes."""
    changed = rig.bench.recipe.model_copy(update=recipe)
    return mating_settings(rig.bench.deck.force_config, changed, Commissioned(), payload_kg)


async def test_without_commissioning_the_bounds_of_the_recipe_count(rig: RunRig) -> None:
    mating = rig.bench.recipe.mating
    figures = (await plan_of(rig, Commissioned())).speed.figures
    assert figures.stop_latency_s == mating.stop_latency_ms / 1e3
    assert figures.stiffness_n_m == mating.stiffness_n_per_mm * 1e3


async def test_what_was_measured_makes_the_approach_faster(rig: RunRig) -> None:
    careful = await plan_of(rig, Commissioned())
    known = await plan_of(rig, Commissioned(stop_latency_s=0.1, stiffness_n_m=2e5))
    assert known.speed.figures.stop_latency_s == 0.1
    assert known.speed.figures.stiffness_n_m == pytest.approx(3e5), "the next pair may be stiffer"
    assert known.speed.speed_m_s > 2 * careful.speed.speed_m_s
    assert known.speed.peak_n <= careful.settings.touch_peak_n + 1e-6
    assert known.creep.stiffness_n_m == pytest.approx(3e5)


def test_pins_of_the_recipe_end_the_fast_travel_above_them(rig: RunRig) -> None:
    pins = Pins(engagement_mm=3.0, max_yaw_deg=0.02, max_travel_mm=0.1)
    mating = rig.bench.recipe.mating.model_copy(update={"pins": pins})
    settings = settings_of(rig, mating=mating).pins
    assert settings is not None
    assert settings.engagement_m == pytest.approx(3e-3)
    assert settings.greatest_travel_m == pytest.approx(1e-4)
    assert settings.greatest_yaw_rad == pytest.approx(np.radians(0.02))
    assert settings.lateral_stiffness_n_m == pytest.approx(1e6)
    assert settings.yaw_stiffness_n_m_rad == pytest.approx(3e5, rel=0.02)


def test_a_search_for_pins_is_the_recipe_s(rig: RunRig) -> None:
    pins = Pins(engagement_mm=3.0, search=PinSearch(radius_mm=0.2, catch_mm=0.1))
    mating = rig.bench.recipe.mating.model_copy(update={"pins": pins})
    settings = settings_of(rig, mating=mating).pins
    assert settings is not None
    assert settings.search_radius_m == pytest.approx(2e-4)
    assert settings.catch_m == pytest.approx(1e-4)


@pytest.mark.parametrize(
    ("pins", "why"),
    [
        ({"search": {"radius_mm": 0.2, "catch_mm": 0.05}}, "too many places"),
        ({"search": {"radius_mm": 0.3, "catch_mm": 0.1}}, "beyond max_travel_mm"),
        ({"search": {"radius_mm": 0.1, "catch_mm": 0.1}, "compliance": False}, "needs compliance"),
    ],
)
def test_a_search_that_cannot_be_made_is_refused(pins: dict[str, Any], why: str) -> None:
    with pytest.raises(ValidationError, match=why):
        Pins.model_validate({"engagement_mm": 3.0, **pins})


def test_spreads_of_part_and_arm_are_the_recipe_s(rig: RunRig) -> None:
    spreads = {"travel_sigma_mm": 0.02, "step_sigma_mm": 0.005}
    mating = rig.bench.recipe.mating.model_copy(update=spreads)
    settings = settings_of(rig, mating=mating, deck_thickness_sigma_mm=0.06)
    assert settings.thickness_sigma_m == pytest.approx(6e-5)
    assert settings.travel_sigma_m == pytest.approx(2e-5)
    assert settings.step_sigma_m == pytest.approx(5e-6)


def test_across_the_pins_the_arm_is_as_stiff_as_the_recipe_says(rig: RunRig) -> None:
    changes = {"pins": Pins(engagement_mm=3.0), "stiffness_n_per_mm": 700.0}
    settings = settings_of(rig, mating=rig.bench.recipe.mating.model_copy(update=changes)).pins
    assert settings is not None
    assert settings.lateral_stiffness_n_m == pytest.approx(7e5)


async def test_a_greater_spread_of_the_thickness_opens_the_window(rig: RunRig) -> None:
    """Good parts of a wider tolerance must not end as contact too early or too late."""
    narrow = await plan_of(rig, Commissioned())
    recipe = rig.bench.recipe.model_copy(update={"deck_thickness_sigma_mm": 0.06})
    corrected = await correct_pose(await at_the_stand_off(rig, recipe=recipe))
    wide = contact_plan(corrected, Commissioned())
    assert wide.window.latest_m - wide.window.expected_m > 2e-4
    assert narrow.window.latest_m - narrow.window.expected_m < 1.5e-4


def test_no_measurement_goes_beyond_the_bound(rig: RunRig) -> None:
    recipe, stiff = rig.bench.recipe, Commissioned(stiffness_n_m=9e5)
    settings = mating_settings(rig.bench.deck.force_config, recipe, stiff, 200.0)
    assert settings.stiffness_n_m == recipe.mating.stiffness_n_per_mm * 1e3


def test_the_shipped_recipe_is_what_the_settings_default_to(rig: RunRig) -> None:
    shipped = settings_of(rig)
    default = MatingSettings(shipped.stop_latency_s, shipped.stiffness_n_m)
    assert shipped == replace(default, stale_s=shipped.stale_s, flange_age_s=shipped.flange_age_s)


def test_force_and_side_force_of_the_recipe_reach_the_seat_and_the_speed(rig: RunRig) -> None:
    mating = rig.bench.recipe.mating
    forces = {"target_force_n": 60.0, "limit_force_n": 90.0, "max_lateral_force_n": 40.0}
    settings = settings_of(rig, mating=mating.model_copy(update=forces))
    assert settings.touch_peak_n == 60.0
    assert settings.seat.force_low_n == 60.0
    assert settings.seat.force_high_n == settings.abort_force_n == 85.0
    assert settings.seat.lateral_n == 32.0


def test_another_deck_has_its_own_size_mass_and_zero(rig: RunRig) -> None:
    mating = rig.bench.recipe.mating.model_copy(
        update={"max_untared_force_n": 30.0, "max_untared_moment_n_m": 12.0}
    )
    settings = settings_of(rig, 70.0, face_mm=(600.0, 400.0), mating=mating)
    assert settings.half_size_m == pytest.approx((0.3, 0.2))
    assert settings.moving_mass_kg == 70.0
    assert settings.plausible == (30.0, 12.0)
    assert settings.seat.moment_n_m == pytest.approx((45.0 * 0.2 + 2.75, 45.0 * 0.3 + 1.5, 4.8))


async def test_a_robot_that_was_slowed_down_meanwhile_gets_no_plan(rig: RunRig) -> None:
    corrected = await correct_pose(await at_the_stand_off(rig))
    rig.bench.cell.main.looks["speed_override_ratio"] = 0.5
    with pytest.raises(SpeedOverridden):
        contact_plan(corrected, Commissioned())


async def test_a_run_is_not_prepared_for_a_head_that_was_taught_another_pose(rig: RunRig) -> None:
    deck = rig.bench.deck
    poses_deg = deck.head_1.config.poses_deg | {"measuring": (0.0,) * 6}
    moved = deck.head_1.config.model_copy(update={"poses_deg": poses_deg})
    deck = replace(deck, head_1=replace(deck.head_1, config=moved))
    with pytest.raises(HeadPoseChanged):
        await read_facts(deck, rig.bench.recipe, rig.bench.calibrations, CALIBRATIONS)


async def test_a_run_is_not_prepared_for_a_robot_that_is_slowed_down(rig: RunRig) -> None:
    rig.bench.cell.main.looks["speed_override_ratio"] = 0.5
    with pytest.raises(SpeedOverridden):
        await read_facts(rig.bench.deck, rig.bench.recipe, rig.bench.calibrations, CALIBRATIONS)


def with_rate(sensor: ForceSensorConfig, rate_hz: float) -> ForceSensorConfig:
    settings = {**sensor.settings, "rate_hz": rate_hz}
    return sensor.model_copy(update={"settings": settings, "stale_ms": 150.0})


@pytest.mark.parametrize(("rate_hz", "threshold_n"), [(500.0, 60.0), (200.0, 60.0), (4e3, 480.0)])
def test_period_touch_and_band_follow_the_rate_of_the_sensor(
    rig: RunRig, rate_hz: float, threshold_n: float
) -> None:
    sensor = with_rate(rig.bench.deck.force_config, rate_hz)
    settings = mating_settings(sensor, rig.bench.recipe, Commissioned(), 200.0)
    assert settings.sample_period_s == 1.0 / rate_hz
    assert settings.touch.threshold_n == pytest.approx(threshold_n)
    lowest_hz, highest_hz = contact_limits(settings).rate_hz
    assert 0.5 * rate_hz < lowest_hz < 0.9 * rate_hz
    assert 1.1 * rate_hz < highest_hz < 1.5 * rate_hz


def test_a_touch_is_noticed_at_the_same_force_whatever_the_rate() -> None:
    ramp_n_s = 100.0
    felt = [
        Cusum(4.0, touch_threshold_n(rate_hz)).force_at_alarm(ramp_n_s, 1.0 / rate_hz)
        for rate_hz in (500.0, 1e3, 4e3)
    ]
    assert felt == pytest.approx([felt[0]] * 3)
