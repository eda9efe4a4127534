"""The catalogue of imperfections: names, scales, and streams that do not disturb each other."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from fakes.imperfections import CATALOGUE, UnknownImperfection, parsed_scale
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.scenes.load import load

CONFIG = Path(__file__).parents[3] / "config"
SHIPPED = CONFIG / "deck.scenario.toml"


def test_each_has_a_size_of_its_own_or_in_the_file_and_a_source() -> None:
    for name, one in CATALOGUE.items():
        assert (one.size > 0) is not bool(one.keys), name
        assert bool(one.unit) is not bool(one.keys), name
        assert one.acts, name
        assert one.source, name


def test_the_deck_cell_says_how_large_each_one_is(shipped_scenario: DeckScenario) -> None:
    own_size = {name for name, one in CATALOGUE.items() if not one.keys}
    assert set(shipped_scenario.imperfections) == own_size
    assert set(shipped_scenario.imperfections.values()) <= {0.0, 1.0}


def test_a_scale_of_the_caller_replaces_that_of_the_file() -> None:
    scenario = load(SHIPPED, {"reducer_ripple": 5.0})
    assert scenario.size_of("reducer_ripple") == 5.0 * CATALOGUE["reducer_ripple"].size
    written = load(SHIPPED).imperfections["base_drift"]
    assert scenario.size_of("base_drift") == written * CATALOGUE["base_drift"].size
    assert scenario.without_imperfections().size_of("reducer_ripple") == 0.0


@pytest.mark.parametrize("name", [name for name, one in CATALOGUE.items() if one.keys])
def test_sizes_of_the_file_are_multiplied(name: str) -> None:
    plain, scaled = load(SHIPPED).model_dump(), load(SHIPPED, {name: 3.0}).model_dump()
    for key in CATALOGUE[name].keys:
        *path, last = key.split(".")
        before, after = plain, scaled
        for step in path:
            place = next(iter(before)) if step == "*" else step
            before, after = before[place], after[place]
        assert np.array(before[last]) != pytest.approx(0.0)
        np.testing.assert_allclose(after[last], 3.0 * np.array(before[last]))


@pytest.mark.parametrize("text", ["reducer_ripple", "reducer_ripple=", "rust=1", "links=-1"])
def test_what_is_no_name_and_scale_is_refused(text: str) -> None:
    with pytest.raises(UnknownImperfection):
        parsed_scale(text)


def test_a_scenario_with_an_unknown_one_is_refused(scenario: DeckScenario) -> None:
    with pytest.raises(ValidationError, match="there is no imperfection 'rust'"):
        DeckScenario.model_validate(scenario.model_dump() | {"imperfections": {"rust": 1.0}})


def _drawn(scales: dict[str, float]) -> np.ndarray:
    """What the arms, the sensor and the heads of a cell draw, after a motion of each arm."""
    scenario = DeckScenario.read(SHIPPED).without_imperfections()
    world = DeckOnFrame(scenario.model_copy(update={"imperfections": scales}), 1)
    for arm in world.arms.values():
        arm.start_joint(0.0, arm.joints(0.0) + 0.1, 100)
    world.advance(5.0)
    drawn = [world.sensor_wrench("force", world.time_s)]
    drawn += [world.flange(name).as_matrix().ravel() for name in world.arms]
    drawn += [world.camera_pose(name).as_matrix().ravel() for name in world.truth.cameras]
    return np.concatenate(drawn)


@pytest.mark.parametrize("name", [name for name, one in CATALOGUE.items() if not one.keys])
def test_switching_one_on_leaves_the_draws_of_the_others(name: str) -> None:
    """A size of almost nothing changes the world by almost nothing."""
    np.testing.assert_allclose(_drawn({name: 1e-9}), _drawn({}), atol=1e-6)
