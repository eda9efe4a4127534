"""The loop without wire and clock is that of the process, on the shipped cell."""

from io import StringIO

import numpy as np
import pytest
from rich.console import Console
from scipy.spatial.transform import RigidTransform

from benchmarks.metrology import loop
from benchmarks.metrology.fake_station import SCENARIO, FakeStation
from fakes.scenes.deck_on_frame.scenario import DeckScenario


def test_the_shipped_recipe_knows_the_long_axis_least() -> None:
    thresholds = np.degrees(loop.Setting.shipped().thresholds.rotation_rad)
    np.testing.assert_allclose(thresholds, [0.014, 0.006, 0.006])


def test_a_flange_that_is_sent_somewhere_reports_to_be_there() -> None:
    scenario = DeckScenario.read(SCENARIO).without_imperfections()
    station = FakeStation(scenario, 3, loop.Setting.shipped().geometry)
    station.to_deck_measure()
    target = RigidTransform.from_translation([0.0, 0.0, 0.01]) * station.base_T_flange()
    before = station.true_frame_T_deck()
    station.move_flange(target)
    moved = station.true_frame_T_deck().translation - before.translation
    assert moved[2] == pytest.approx(0.01, abs=2e-4)
    assert np.abs((target.inv() * station.base_T_flange()).translation).max() < 1e-4


def test_errors_are_told_in_their_own_sigmas() -> None:
    look = {
        "error_mm_deg": [0.0] * 6,
        "off_truth_mm_deg": [0.002, 0.0, 0.0, 0.0, 0.0, 0.0],
        "sigma_mm_deg": [0.001] * 6,
        "normalised_squared": [12.0],
        "frames": [2.0],
    }
    written = StringIO()
    Console(file=written, width=200).print(loop.normalised([{"looks": [look]}]))
    assert "mean 2.00" in written.getvalue()
    (row,) = [line for line in written.getvalue().splitlines() if "ratio" in line]
    assert row.split("│")[2].strip() == "2.0000"


@pytest.mark.long  # a whole loop draws a dozen pairs of images
def test_a_drawn_cell_converges_within_its_thresholds() -> None:
    setting = loop.Setting.shipped()
    result = loop.run_loop(setting, DeckScenario.read(SCENARIO), 3)
    assert result["converged"]
    assert len(result["looks"]) <= 3
    off = np.abs(result["looks"][-1]["off_truth_mm_deg"]) / result["looks"][-1]["sigma_mm_deg"]
    assert off.max() < 4.0
