"""The catalogue of imperfections: names, scales, and streams that do not disturb each other."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from fakes.imperfections import CATALOGUE, UnknownImperfection, parsed_scale
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.scenes.load import load
from fakes.world.scene import StereoTruth
from tests.rigs.sweeps import sweep

CONFIG = Path(__file__).parents[3] / "config"
SHIPPED = CONFIG / "deck.scenario.toml"


RENDERED = ("image_noise", "uneven_light", "glare", "tilt_shading", "deck_flex")
"""What the renderer makes of a scene: the seeds that a scene carries have a test of their own."""


def quickly(names: Sequence[str]) -> list[object]:
    """The first of each kind of seed; all others are figures."""
    kinds = {CATALOGUE[name].drawn_by: name for name in reversed(names) if name not in RENDERED}
    return sweep(names, kinds.values())


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


def _drawn(scales: Mapping[str, float]) -> np.ndarray:
    """What the arms, the sensor and the heads of a cell draw, after a motion of each arm."""
    scenario = DeckScenario.read(SHIPPED).without_imperfections()
    world = DeckOnFrame(scenario.model_copy(update={"imperfections": scales}), 1)
    for arm in world.arms.values():
        arm.start_joint(0.0, arm.joints(0.0) + 0.1, 100)
    world.advance(2.0)
    drawn = [world.sensor_wrench("force", world.time_s)]
    drawn += [world.flange(name).as_matrix().ravel() for name in world.arms]
    drawn += [world.camera_pose(name).as_matrix().ravel() for name in world.truth.cameras]
    return np.concatenate(drawn)


@cache
def _drawn_without_any() -> np.ndarray:
    return _drawn({})


@pytest.mark.parametrize("name", quickly([name for name, one in CATALOGUE.items() if not one.keys]))
def test_switching_one_on_leaves_the_draws_of_the_others(name: str) -> None:
    """A size of almost nothing changes the world by almost nothing."""
    np.testing.assert_allclose(_drawn({name: 1e-9}), _drawn_without_any(), atol=1e-6)


def _scenario(scales: Mapping[str, float], hardware_seed: int) -> DeckScenario:
    """The shipped cell with none of the catalogue's sizes but these, and with other devices."""
    alone = {name: 0.0 for name, one in CATALOGUE.items() if not one.keys}
    shipped = DeckScenario.read(SHIPPED, alone | dict(scales))
    return shipped.model_copy(update={"hardware_seed": hardware_seed})


def _observed(scenario: DeckScenario, seed: int) -> dict[str, np.ndarray]:
    """What can be seen of a cell whose arms set out, are stopped on their way, and stand."""
    world = DeckOnFrame(scenario, seed)
    arms, cameras = world.arms.items(), world.truth.cameras
    for _, arm in arms:
        arm.start_joint(0.0, arm.joints(0.0) + 0.3, 100)
    world.advance(0.6)
    seen = {f"{name} on its way": world.flange(name).as_matrix() for name, _ in arms}
    for _, arm in arms:
        arm.stop(world.time_s)
    world.advance(2.0)
    seen |= {f"{name} stopped": world.flange(name).as_matrix() for name, _ in arms}
    seen["sensor"] = world.sensor_wrench("force", world.time_s)
    seen |= {f"{name} at": world.camera_pose(name).as_matrix() for name in cameras}
    exposures = [world.camera_scene("head_1").exposure for _ in range(3)]
    seen["sway"] = np.array([one.sway_rad for one in exposures])
    seen["gain"] = np.array([one.gain for one in exposures])
    optics = cameras["head_1"].optics
    assert isinstance(optics, StereoTruth)
    seen["lens"] = np.array(optics.left.focal_px)
    seen["waves"] = optics.left.misfit[0] * np.sin(optics.left.misfit[1:])
    parts = world.placed.parts
    assert parts is not None
    seen["grip"] = parts.flange_T_deck.as_matrix()
    seen["burr"] = np.array(parts.burr_m or (0.0, 0.0, 0.0))
    return seen


@cache
def _observed_before(hardware_seed: int, seed: int) -> dict[str, np.ndarray]:
    """What is seen with none of the catalogue's sizes, and with those of the file as they are."""
    return _observed(_scenario({}, hardware_seed), seed)


def _effect(name: str, *, hardware_seed: int, seed: int) -> dict[str, np.ndarray]:
    """By how much one imperfection alone changes what can be seen, where it does."""
    with_it = 3.0 if CATALOGUE[name].keys else 1.0
    before = _observed_before(hardware_seed, seed)
    after = _observed(_scenario({name: with_it}, hardware_seed), seed)
    changes = {key: after[key] - before[key] for key in before}
    return {key: change for key, change in changes.items() if np.abs(change).max() > 1e-9}


def _alike(one: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray]) -> bool:
    """Equal but for what they do to each other, which is of second order."""
    return one.keys() == other.keys() and all(
        np.abs(one[key] - other[key]).max() < 0.05 * np.abs(one[key]).max() for key in one
    )


@pytest.mark.parametrize("name", quickly(sorted(CATALOGUE.keys() - set(RENDERED))))
def test_each_is_drawn_by_the_seed_that_the_catalogue_says(name: str) -> None:
    effect = _effect(name, hardware_seed=1, seed=1)
    assert effect, "it acts on nothing that can be seen"
    another_run = _alike(effect, _effect(name, hardware_seed=1, seed=2))
    assert another_run is (CATALOGUE[name].drawn_by != "run")
    if CATALOGUE[name].drawn_by == "hardware":
        assert not _alike(effect, _effect(name, hardware_seed=2, seed=1))


def test_light_belongs_to_the_devices_and_noise_to_the_run() -> None:
    scenario = _scenario({}, 1)
    one, other = (DeckOnFrame(scenario, seed).camera_scene("head_1") for seed in (1, 2))
    assert one.light_seed == other.light_seed
    assert one.noise_seed != other.noise_seed
    assert CATALOGUE["uneven_light"].drawn_by == CATALOGUE["glare"].drawn_by == "hardware"
    assert CATALOGUE["image_noise"].drawn_by == "run"
