"""Pressing the deck on the frame with the whole world in between."""

import numpy as np
import pytest

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from tests.unit.fakes.world.driving import (
    above,
    deck_to,
    hovering,
    mean_reading,
    undeflected_gap_m,
)


def test_static_force_is_springs_in_series_times_depth(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(scenario, 1))
    deck_to(world, above(world, -40e-6), 1e-3, 0.02, settle_s=3.0)
    parts = world.placed.parts
    assert parts is not None
    robot = scenario.payload.stiffness_n_m[2]
    series = robot * parts.contact_stiffness_n_m / (robot + parts.contact_stiffness_n_m)
    expected = -undeflected_gap_m(world) * series
    assert 10 < expected < 40
    assert world.payload.contact_force_n == pytest.approx(expected, rel=0.02)
    assert world.payload.peak_contact_force_n >= world.payload.contact_force_n


def test_sensor_feels_what_the_frame_pushes(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(scenario, 2))
    tare = mean_reading(world)
    deck_to(world, above(world, -50e-6), 1e-3, 0.02, settle_s=3.0)
    change = mean_reading(world) - tare
    assert -change[2] == pytest.approx(world.payload.contact_force_n, abs=1.0)
    assert np.abs(change[:2]).max() < 4


def test_speed_makes_the_peak(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(scenario, 1), 0.5e-3)
    peaks = []
    for speed in (0.3e-3, 2e-3):
        deck_to(world, above(world, 0.5e-3))
        deck_to(world, above(world, -30e-6), speed, 0.02)
        peaks.append(world.payload.peak_contact_force_n - world.payload.contact_force_n)
    assert peaks[1] > 3 * peaks[0] > 0


def test_no_force_before_contact_and_none_after_it(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(scenario, 3))
    assert world.payload.peak_contact_force_n == 0
    deck_to(world, above(world, -30e-6), 1e-3, 0.02)
    assert world.payload.contact_force_n > 5
    deck_to(world, above(world, 3e-3), 5e-3, 0.05)
    assert world.payload.contact_force_n == 0


def test_foreign_body_is_met_early(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(scenario, 4))
    world.faults.inject("foreign_body", height_mm=1.0, x_mm=-480.0, y_mm=0.0)
    world.rebuild()
    deck_to(world, above(world, 0.98e-3), 1e-3, 0.02)
    assert world.payload.contact_force_n > 3


def test_caught_chamfer_pushes_aside(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(scenario, 4))
    tare = mean_reading(world)
    world.faults.inject("pin_catch", height_mm=1.0)
    world.rebuild()
    deck_to(world, above(world, 0.97e-3), 1e-3, 0.02)
    change = mean_reading(world) - tare
    assert world.payload.contact_force_n > 5
    assert np.hypot(change[0], change[1]) > 0.3 * world.payload.contact_force_n


def test_without_a_frame_there_is_nothing_to_touch(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(scenario, 1))
    world.set_present(frame=False)
    deck_to(world, above(world, -2e-3), 0.01, 0.1)
    assert world.payload.peak_contact_force_n == 0


@pytest.mark.figures  # beside no force before contact
def test_deck_beside_the_frame_touches_nothing(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(scenario, 1), 30e-3)
    deck_to(world, above(world, 30e-3, x_m=1.2), 0.2, 1.0)
    deck_to(world, above(world, -5e-3, x_m=1.2), 0.05, 0.5)
    assert world.payload.peak_contact_force_n == 0


def test_gauges_show_a_lateral_offset(scenario: DeckScenario) -> None:
    world = hovering(DeckOnFrame(scenario, 5))
    deck_to(world, above(world, 0.5e-3, x_m=0.1e-3), 0.01, 0.1)
    for pin in world.report()["pins"].values():
        assert pin["offset_mm"] == pytest.approx(0.1, abs=0.03)
        assert pin["gauge_mm"] == pytest.approx(6.0 - pin["offset_mm"], abs=0.0101)
        assert pin["gauge_mm"] <= 6.0 - pin["offset_mm"] + 1e-6
