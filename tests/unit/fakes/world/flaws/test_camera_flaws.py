"""Each imperfection of a camera's place and light has the size that the catalogue says."""

import numpy as np
import pytest

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.world.flaws.camera import CameraFlaws
from fakes.world.frames import distance
from fakes.world.scene import Exposure, StereoTruth


def with_scales(scenario: DeckScenario, **scales: float) -> DeckScenario:
    return scenario.model_copy(update={"imperfections": scales})


def test_a_still_cell_has_plain_exposures(scenario: DeckScenario) -> None:
    assert DeckOnFrame(scenario, 1).camera_scene("head_1").exposure == Exposure()


def test_the_line_of_sight_sways_and_smears(scenario: DeckScenario) -> None:
    flaws = CameraFlaws.of(with_scales(scenario, vibration=1.0), "head_1", 1)
    exposures = [flaws.exposure(1, time_s) for time_s in np.arange(0, 1, 1e-3)]
    sway = np.array([one.sway_rad for one in exposures])
    np.testing.assert_allclose(sway.std(axis=0), 10e-6, rtol=1e-2)
    smear = np.array([one.smear_rad for one in exposures])
    # At the fastest moment 8 ms of a sine of 12 Hz: 0.6 of its amplitude, evenly spread.
    assert smear.max() == pytest.approx(10e-6 * np.sqrt(2) * 0.603 / np.sqrt(12), rel=1e-2)


def test_the_brightness_differs_from_exposure_to_exposure(scenario: DeckScenario) -> None:
    flaws = CameraFlaws.of(with_scales(scenario, exposure_drift=1.0), "head_1", 1)
    gains = np.array([flaws.exposure(number, 0.0).gain for number in range(300)])
    assert np.abs(gains - 1).max() == pytest.approx(0.02, rel=0.02)
    assert flaws.exposure(7, 5.0).gain == gains[7]


def test_a_head_is_not_quite_where_it_was_calibrated(scenario: DeckScenario) -> None:
    moved_m = []
    for seed in range(1, 9):
        plain = DeckOnFrame(scenario, seed).camera_pose("head_1")
        drifted = DeckOnFrame(with_scales(scenario, head_drift=1.0), seed).camera_pose("head_1")
        moved_m.append(distance(plain, drifted)[0])
    assert np.median(moved_m) > 5e-6
    assert max(moved_m) < 15e-6 * np.sqrt(3)


def test_lenses_get_waves_and_keep_all_else(scenario: DeckScenario) -> None:
    plain = DeckOnFrame(scenario, 1).truth.cameras["head_1"].optics
    waved = DeckOnFrame(with_scales(scenario, lens_misfit=1.0), 1).truth.cameras["head_1"].optics
    assert isinstance(plain, StereoTruth)
    assert isinstance(waved, StereoTruth)
    assert waved.left.misfit[0] * scenario.optics["head"].focal_px == pytest.approx(0.05)
    assert waved.left.misfit != waved.right.misfit
    assert waved.left.distortion == plain.left.distortion
    assert waved.right.focal_px == plain.right.focal_px
