"""A drawing of other holes is told from one hole with a burr."""

from dataclasses import replace

import pytest

from cellctl.vision.diameters import other_diameters
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import PairMeasurement
from tests.unit.vision.plates import (
    Light,
    holes_triangle,
    plate_facing,
    render_pair,
    table_1_head,
)

HEAD = table_1_head()
HOLES = holes_triangle(("pin", "pin", "countersink"))


@pytest.fixture(scope="module")
def measured() -> PairMeasurement:
    images = render_pair(HEAD, plate_facing(3.0, -2.0, 2.0), HOLES, Light())
    return measure_pair(*images, HEAD, HOLES)


def test_holes_as_drawn_are_no_mistake(measured: PairMeasurement) -> None:
    assert other_diameters(measured, HOLES) == ""


def test_all_holes_narrower_in_the_drawing_are_named(measured: PairMeasurement) -> None:
    drawn = [replace(hole, diameter_m=hole.diameter_m * 15.0 / 16.0) for hole in HOLES]
    assert "all holes are 1.06" in other_diameters(measured, drawn)


def test_one_hole_alone_is_no_other_drawing(measured: PairMeasurement) -> None:
    drawn = [replace(HOLES[0], diameter_m=HOLES[0].diameter_m * 15.0 / 16.0), *HOLES[1:]]
    assert other_diameters(measured, drawn) == ""
