"""The picture of a teaching, and what it draws."""

from pathlib import Path

import numpy as np
import pytest

from cellctl.processes.antenna_module.calibrations import PLUG_CORRECTION
from cellctl.processes.antenna_module.chain.schemes import DIFFERENCE
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.chain.teaching.taught_picture import taught_picture
from cellctl.processes.antenna_module.chain.teaching.teaching import teach_plug
from tests.rigs.antenna import exact_cell as exact


@pytest.fixture(scope="module")
def correction() -> PlugCorrection:
    plugs = exact.taught_plugs(6, scatter_m=8e-6)
    return teach_plug({"slot 1": plugs}, exact.cell(), DIFFERENCE)


def test_single_plugs_scatter_about_their_mean(correction: PlugCorrection) -> None:
    (slot,) = correction.slots
    assert slot.from_mean.shape == (6, 3)
    assert np.abs(slot.from_mean.mean(axis=0)).max() < 1e-8
    rms_m = np.sqrt((slot.from_mean[:, :2] ** 2).sum() / (2 * 5))
    assert rms_m == pytest.approx(slot.scatter_m)


def test_a_teaching_has_a_picture(correction: PlugCorrection) -> None:
    assert taught_picture(correction).startswith(b"\x89PNG")


def test_a_stored_correction_has_lost_its_single_plugs_but_not_its_picture(
    correction: PlugCorrection,
) -> None:
    again = PlugCorrection.from_record(correction.to_record())
    assert again.slots[0].from_mean.shape == (0, 3)
    assert taught_picture(again).startswith(b"\x89PNG")


def test_every_shipped_calibration_has_its_picture() -> None:
    records = sorted(Path("config/antenna-calibration").glob("*.json"))
    assert PLUG_CORRECTION.for_recipe(1).name in {path.stem for path in records}
    for path in records:
        assert path.with_suffix(".png").read_bytes().startswith(b"\x89PNG"), path
