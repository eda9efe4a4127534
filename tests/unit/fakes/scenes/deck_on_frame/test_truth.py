import pickle

import numpy as np
import pytest
from pydantic import ValidationError

from fakes.scenes.deck_on_frame.gauges import largest_gauge_mm
from fakes.scenes.deck_on_frame.parts import draw_parts
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.taught import taught
from fakes.world.frames import to_written
from fakes.world.truth import draw
from tests.unit.fakes.world.driving import above, deck_to, hovering


def frozen(value: object) -> bytes:
    return pickle.dumps(value)


def test_seed_reproduces_the_cell_and_another_seed_does_not(scenario: DeckScenario) -> None:
    assert frozen(draw(scenario, 7)) == frozen(draw(scenario, 7))
    assert frozen(draw(scenario, 7)) != frozen(draw(scenario, 8))
    assert frozen(draw_parts(scenario, 7, 1)) == frozen(draw_parts(scenario, 7, 1))
    assert frozen(draw_parts(scenario, 7, 1)) != frozen(draw_parts(scenario, 7, 2))


def test_seed_reproduces_a_run(scenario: DeckScenario) -> None:
    reports = []
    for _ in range(2):
        world = hovering(DeckOnFrame(scenario, 11))
        deck_to(world, above(world, -30e-6), 1e-3, 0.02)
        reports.append((world.report(), world.sensor_wrench("force", world.time_s).tolist()))
    assert reports[0] == reports[1]


def test_run_does_not_depend_on_the_size_of_the_time_steps(scenario: DeckScenario) -> None:
    reports = []
    for step_s in (0.5, 0.0017):
        world = DeckOnFrame(scenario, 11)
        world.arms["main"].start_joint(0.0, np.deg2rad([10, -80, 100, 0, 60, 90]), 100)
        for time_s in np.arange(0, 4, step_s):
            world.advance(time_s)
        world.advance(4.0)
        reports.append(world.report())
    assert reports[0] == reports[1]


def test_parts_are_displaced_within_their_bounds(scenario: DeckScenario) -> None:
    nominal = np.array(scenario.parts.frame_mm_deg)
    offsets = np.array(
        [to_written(draw_parts(scenario, seed, 1).cell_T_frame) - nominal for seed in range(100)]
    )
    assert np.abs(offsets[:, :3]).max() < 5.1
    assert np.abs(offsets[:, 0]).max() > 4
    assert 0.4 < np.abs(offsets[:, 3]).max() <= 0.51


def test_contact_stiffness_covers_its_range(scenario: DeckScenario) -> None:
    drawn = [draw_parts(scenario, seed, 1).contact_stiffness_n_m for seed in range(100)]
    low, high = scenario.contact.stiffness_n_m
    assert low <= min(drawn) < 1.2 * low
    assert high >= max(drawn) > 0.8 * high


def test_unknown_keys_and_missing_ones_are_errors(scenario: DeckScenario) -> None:
    values = scenario.model_dump()
    with pytest.raises(ValidationError, match="colour"):
        DeckScenario.model_validate(values | {"colour": "blue"})
    del values["contact"]
    with pytest.raises(ValidationError, match="contact"):
        DeckScenario.model_validate(values)


@pytest.mark.parametrize(
    ("opening_mm", "gauge_mm"), [(6.0, 6.0), (5.999, 5.99), (5.85, 5.85), (-3.0, 0.0)]
)
def test_gauges_come_in_hundredths(opening_mm: float, gauge_mm: float) -> None:
    assert largest_gauge_mm(opening_mm) == gauge_mm


def test_taught_poses_name_all_robots_and_heads(scenario: DeckScenario) -> None:
    poses = taught(scenario)
    assert set(poses["robots"]["main"]["poses"]) == {"home", "clear", "deck_measure"}
    assert set(poses["robots"]["aux_2"]["poses"]) == {"home", "measure", "retracted"}
    assert poses["cameras"]["head_1"]["carried_by"] == "aux_1"
