"""A contact that shows as two spots is still one contact; what is stated of a fit is true."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from cellctl.processes.antenna_module.faults.connector import ConnectorUncertain
from cellctl.processes.antenna_module.vision.measure import (
    contact_pattern,
    measure_connector,
    seen_depth_m,
)
from cellctl.processes.antenna_module.vision.pattern import find_pattern, surplus
from tests.rigs.antenna.outcomes import outcome
from tests.rigs.antenna.pictures import CLEAN, HOLES, trial

BESIDE = 30
"""Seed of a picture of a good D-sub socket in which one search begins beside its hole."""
TWICE = 39
"""Seed of a picture in which two holes of a good socket are found as two spots each."""


def test_a_hole_that_is_found_twice_is_no_hole_too_many() -> None:
    given = trial(TWICE, HOLES)
    connector, image = given.connector, given.pixels.plane
    plane = given.plane.before(given.camera).at_height(-seen_depth_m(connector))
    pattern = contact_pattern(connector)
    candidates = find_pattern(image, plane, pattern, least=9)
    assert len(candidates.spots.px) > len(connector.contacts)
    assert surplus(image, plane, pattern, candidates, connector.outline_m) == 0
    found = measure_connector(image, given.camera, given.plane, connector)
    assert all(contact.state == "ok" for contact in found.contacts)


def test_a_hole_whose_search_began_beside_it_is_found_again() -> None:
    given = trial(BESIDE, replace(HOLES, name="d-sub-15"))
    found = measure_connector(given.pixels.plane, given.camera, given.plane, given.connector)
    assert [contact.name for contact in found.contacts if contact.state != "ok"] == []


@pytest.mark.parametrize(
    ("seeds", "least", "most"),
    [(2, 0.05, 4.0), pytest.param(8, 0.4, 2.2, marks=pytest.mark.figures)],
)
def test_errors_are_as_large_as_is_stated_of_them(seeds: int, least: float, most: float) -> None:
    squares = []
    for seed in range(seeds):
        given = trial(seed, replace(CLEAN, wall_light=0.5, um_per_px=(35.0, 35.0)))
        image, camera, plane = given.pixels.plane, given.camera, given.plane
        measured = outcome(given, partial(measure_connector, image, camera, plane, given.connector))
        assert not measured.fault
        squares.append(measured.nees / 3.0)
    assert least < np.mean(squares) < most


def test_a_yaw_that_is_known_to_no_better_than_0_02_degrees_is_refused() -> None:
    poor = replace(CLEAN, noise_grey=3.0, blur_px=(2.0, 2.0), um_per_px=(35.0, 35.0))
    given = trial(3, poor)
    with pytest.raises(ConnectorUncertain, match=r"0\.03\d°"):
        measure_connector(given.pixels.plane, given.camera, given.plane, given.connector)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("micro-d-15", marks=pytest.mark.figures),
        pytest.param("d-sub-15", marks=pytest.mark.long),
    ],
)
def test_holes_beside_the_axis_are_not_drawn_towards_it(name: str) -> None:
    """The lit wall of a bore moves its rim by 1 µm a millimetre, alike in every socket."""
    beside, along = [], []
    for seed in range(6):
        given = trial(seed, replace(HOLES, name=name, one_sided=0.0))
        found = measure_connector(given.pixels.plane, given.camera, given.plane, given.connector)
        true_m = given.truth.translation[:2]
        error_m = found.camera_T_connector.pose.translation[:2] - true_m
        beside.append(float(true_m @ true_m))
        along.append(float(error_m @ true_m))
    assert abs(sum(along) / sum(beside)) < 0.5e-3
