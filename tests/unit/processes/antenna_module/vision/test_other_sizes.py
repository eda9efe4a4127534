"""A drawing with a radius in place of a diameter is told by the first picture."""

from dataclasses import replace

import pytest

from cellctl.processes.antenna_module.faults.connector import LightFromOneSide, MarksMissing
from cellctl.processes.antenna_module.vision.measure import measure_connector, measure_marks
from tests.rigs.antenna.pictures import CLEAN, Conditions, trial
from tests.rigs.sweeps import sweep


@pytest.mark.parametrize("size", sweep((0.5, 2.0), (0.5,)))
def test_marks_of_another_size_are_named(size: float) -> None:
    given = trial(1, Conditions(marks=True, um_per_px=(35.0, 35.0), height_sigma_m=0.2e-3))
    assert given.marks is not None
    drawn = replace(given.marks, diameter_m=size * given.marks.diameter_m)
    with pytest.raises(MarksMissing, match=r"5 spots of 2\.00 mm diameter lie as .* the radius"):
        measure_marks(given.pixels.plane, given.camera, given.plane, drawn)


def test_pins_of_half_the_diameter_are_not_put_down_to_the_light_alone() -> None:
    given = trial(1, CLEAN)
    drawn = replace(given.connector, diameter_m=0.5 * given.connector.diameter_m)
    with pytest.raises(LightFromOneSide, match="or is diameter_mm of the drawing the radius"):
        measure_connector(given.pixels.plane, given.camera, given.plane, drawn)
