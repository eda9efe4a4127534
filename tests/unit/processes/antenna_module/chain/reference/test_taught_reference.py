"""A reference comes back from its record as it was, and belongs to its calibrations."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cellctl.processes.antenna_module.chain.reference.taught_reference import TaughtReference
from cellctl.processes.antenna_module.chain.teaching.made_with import ReferenceMadeWith
from cellctl.processes.antenna_module.faults.plugging import CalibrationsDoNotBelongTogether
from tests.rigs.antenna.exact_cell import cell
from tests.unit.processes.antenna_module.chain.reference_draws import ARM, drawn_looks


@pytest.fixture
def taught() -> TaughtReference:
    looks = drawn_looks(12, np.random.default_rng(3))
    return TaughtReference(ReferenceMadeWith.of(cell()), looks.reading(ARM), looks.checks(ARM))


def test_the_record_is_read_back(taught: TaughtReference) -> None:
    again = TaughtReference.from_record(json.loads(json.dumps(taught.to_record())))
    assert again.made_with == taught.made_with
    assert again.checks == taught.checks
    assert again.reading.sigma_m == pytest.approx(taught.reading.sigma_m)
    np.testing.assert_allclose(again.reading.stacked(), taught.reading.stacked(), rtol=1e-12)


@pytest.mark.parametrize(
    "damage",
    [
        {"marks_from_axis_mm": [0.1]},
        {"plate_in_camera_1_mm": [0.1, float("nan")]},
        {"sigma_mm": 0.0},
        {"axis_in_camera_2_mm": "here"},
    ],
)
def test_a_damaged_record_is_refused(taught: TaughtReference, damage: dict[str, Any]) -> None:
    with pytest.raises((ValueError, TypeError)):
        TaughtReference.from_record(taught.to_record() | damage)


def test_it_does_not_compare_with_other_calibrations(taught: TaughtReference) -> None:
    now = ReferenceMadeWith.of(cell())
    taught.made_with.require(now)
    with pytest.raises(CalibrationsDoNotBelongTogether, match="cam1 hand-eye 1, now hand-eye 9"):
        taught.made_with.require(replace(now, cam1="hand-eye 9"))
