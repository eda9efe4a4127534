"""Which spot is which contact, with contacts missing, spots too many, and patterns turned."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.connector.connector import read_connector
from cellctl.processes.antenna_module.connector.marks import read_marks
from cellctl.processes.antenna_module.faults.connector import (
    ConnectorAmbiguous,
    ConnectorMisplaced,
    ConnectorTurned,
    ImageMirrored,
)
from cellctl.processes.antenna_module.vision import matching
from cellctl.processes.antenna_module.vision.choice import PlanarExpectation, choose
from cellctl.processes.antenna_module.vision.contact_fit.spots import Spots
from cellctl.processes.antenna_module.vision.matching import (
    Placement,
    looks_alike_in_mirror,
    placements,
    rotation,
)
from cellctl.processes.antenna_module.vision.pattern import Candidates

CONNECTOR = read_connector(Path("config/connectors/micro-d-15-pins.toml"))
PLUG = CONNECTOR.positions_m
MARKS = read_marks(Path("config/connectors/gripper.toml")).positions_m
SHIFT = np.array([0.4e-3, -0.3e-3])


def seen(drawing: Array, yaw_deg: float) -> Array:
    rng = np.random.default_rng(4)
    noise = rng.normal(0.0, 10e-6, drawing.shape)
    return np.asarray(drawing @ rotation(float(np.radians(yaw_deg))).T + SHIFT + noise)


def candidates(drawing: Array, spots: Array) -> Candidates:
    def found(pattern: Array) -> tuple[Placement, ...]:
        least = int(np.ceil(0.6 * len(drawing)))
        return tuple(placements(pattern, spots, least=least, reach_m=0.4e-3))

    contrast = np.full(len(spots), 50.0)
    return Candidates(Spots(spots, contrast), spots, found(drawing), found(drawing * [-1.0, 1.0]))


def expected(yaw_deg: float = 0.0) -> PlanarExpectation:
    return PlanarExpectation(np.zeros(2), float(np.radians(yaw_deg)), 2e-3, float(np.radians(5.0)))


@pytest.mark.parametrize("yaw_deg", [0.0, 37.0, 179.0, -120.0])
def test_a_plug_is_found_at_any_angle(yaw_deg: float) -> None:
    placement = choose(candidates(PLUG, seen(PLUG, yaw_deg)), None, chiral=False)
    assert placement.found == 15
    assert np.array_equal(placement.spot, np.arange(15))
    turn = np.degrees(placement.yaw_rad) - yaw_deg
    assert abs((turn + 180.0) % 360.0 - 180.0) < 0.2


def test_spots_that_belong_to_nothing_and_a_missing_contact_are_allowed_for() -> None:
    spots = np.delete(seen(PLUG, 10.0), 4, axis=0)
    dirt = np.random.default_rng(8).uniform(-8e-3, 8e-3, (6, 2)) + np.array([0.0, 8e-3])
    placement = choose(candidates(PLUG, np.vstack([dirt, spots])), None, chiral=False)
    assert placement.spot[4] == -1
    assert placement.found == 14


def test_without_an_end_contact_both_rows_are_alike_and_only_the_place_decides() -> None:
    spots = np.delete(seen(PLUG, 2.0), 7, axis=0)
    with pytest.raises(ConnectorAmbiguous, match="14 features fit at"):
        choose(candidates(PLUG, spots), None, chiral=False)
    placement = choose(candidates(PLUG, spots), expected(), chiral=False)
    assert placement.spot[7] == -1


def test_half_a_turn_from_the_expected_place_is_named() -> None:
    with pytest.raises(ConnectorTurned, match="°"):
        choose(candidates(PLUG, seen(PLUG, 178.0)), expected(), chiral=False)


def test_far_from_the_expected_place_is_named() -> None:
    with pytest.raises(ConnectorMisplaced, match=r"\+1[12]\.\d+° from where it should be"):
        choose(candidates(PLUG, seen(PLUG, 12.0)), expected(), chiral=False)


def test_marks_tell_a_mirrored_image_with_one_of_them_lost() -> None:
    spots = seen(MARKS, 3.0)
    assert choose(candidates(MARKS, spots), None, chiral=True).found == 5
    mirrored = spots * [-1.0, 1.0]
    with pytest.raises(ImageMirrored):
        choose(candidates(MARKS, mirrored), None, chiral=True)


def test_marks_without_the_odd_one_are_refused() -> None:
    with pytest.raises(ConnectorAmbiguous):
        choose(candidates(MARKS, seen(MARKS, 3.0)[:4]), None, chiral=True)


def test_a_plug_is_alike_in_a_mirror_unless_it_lacks_one_contact_of_a_pair() -> None:
    keyed = np.delete(np.arange(len(PLUG)), 2)
    names = tuple(CONNECTOR.contacts[index] for index in keyed)
    assert looks_alike_in_mirror(replace(CONNECTOR))
    assert not looks_alike_in_mirror(replace(CONNECTOR, contacts=names, positions_m=PLUG[keyed]))


def test_a_drawing_is_compared_with_its_mirror_image_once(monkeypatch: pytest.MonkeyPatch) -> None:
    compared = []

    def counted(drawing_m: Array, spots_m: Array, *, least: int, reach_m: float) -> list[Placement]:
        compared.append(drawing_m)
        return placements(drawing_m, spots_m, least=least, reach_m=reach_m)

    monkeypatch.setattr(matching, "placements", counted)
    plug = replace(CONNECTOR)
    assert looks_alike_in_mirror(plug) == looks_alike_in_mirror(plug)
    assert len(compared) == 1
