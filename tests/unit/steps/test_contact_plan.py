"""What a contact is planned with: the recipe's bounds, or what commissioning has measured."""

import numpy as np
import pytest

from cellctl.cell.commissioned import Commissioned
from cellctl.config.recipe import Pins
from cellctl.steps.compensate import compensate
from cellctl.steps.contact_plan import contact_plan, mating_settings
from cellctl.steps.mating.plan import MatingPlan
from tests.unit.steps.rig import RunRig
from tests.unit.steps.test_steps import at_the_stand_off


async def plan_of(rig: RunRig, commissioned: Commissioned) -> MatingPlan:
    run = await at_the_stand_off(rig)
    await compensate(run)
    return contact_plan(run, commissioned)


async def test_without_commissioning_the_bounds_of_the_recipe_count(rig: RunRig) -> None:
    mating = rig.run().recipe.mating
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
    config = rig.bench.cell.config
    pins = Pins(engagement_mm=3.0, max_yaw_deg=0.02, max_travel_mm=0.1)
    mating = config.recipes[0].mating.model_copy(update={"pins": pins})
    settings = mating_settings(config, mating, Commissioned()).pins
    assert settings is not None
    assert settings.engagement_m == pytest.approx(3e-3)
    assert settings.greatest_travel_m == pytest.approx(1e-4)
    assert settings.greatest_yaw_rad == pytest.approx(np.radians(0.02))
    assert settings.lateral_stiffness_n_m == pytest.approx(1e6)
    assert settings.yaw_stiffness_n_m_rad == pytest.approx(3e5, rel=0.02)


def test_no_measurement_goes_beyond_the_bound(rig: RunRig) -> None:
    config = rig.bench.cell.config
    stiff = Commissioned(stiffness_n_m=9e5)
    settings = mating_settings(config, config.recipes[0].mating, stiff)
    assert settings.stiffness_n_m == config.recipes[0].mating.stiffness_n_per_mm * 1e3
