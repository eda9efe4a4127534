"""Each fault has its verdict, and good insertions of all lots have none."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cellctl.processes.antenna_module.connector.connector import read_connector
from cellctl.processes.antenna_module.faults.plugging import (
    PlugBentPin,
    PlugEarlyContact,
    PluggingError,
    PlugOverForce,
    PlugShortSeat,
    PlugSideForce,
)
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits, InsertionPhase
from cellctl.processes.antenna_module.insertion.verdict import InsertionVerdict, judge_insertion
from cellctl.processes.antenna_module.insertion.watch import InsertionWatch, TripCause
from tests.rigs.antenna.curves import Shape, curve

CONNECTOR = read_connector(Path("config/connectors/micro-d-15-holes.toml"))
LIMITS = InsertionLimits.of(CONNECTOR)
GOOD = Shape()
FAULTS = [
    pytest.param(Shape(pin_n_per_mm=115, pin_mm=(-4.4, 0.5)), "bent_pin", PlugBentPin, id="bent"),
    pytest.param(Shape(pin_n_per_mm=409), "early", PlugEarlyContact, id="all on the face"),
    pytest.param(Shape(side_n=6, axial_per_side=0.8), "side", PlugSideForce, id="offset"),
    pytest.param(Shape(moment_z_n_m=0.14), "side", PlugSideForce, id="yaw"),
    pytest.param(Shape(seat_mm=2.2), "short", PlugShortSeat, id="early seat"),
    pytest.param(Shape(end_n=0.3), "short", PlugShortSeat, id="no seat"),
    pytest.param(Shape(peak_n=60), "over", PlugOverForce, id="tight lot"),
]


@pytest.mark.parametrize("peak_n", [6.0, 12.0, 24.0, 36.0])
@pytest.mark.parametrize("seed", range(5))
def test_good_insertions_of_all_lots_are_seated(peak_n: float, seed: int) -> None:
    judgement = judge_insertion(curve(replace(GOOD, peak_n=peak_n), seed), CONNECTOR)
    assert judgement.verdict is InsertionVerdict.SEATED, judgement.checks
    assert judgement.fault is None
    assert judgement.features.seat_depth_m == pytest.approx(2.5e-3, abs=0.12e-3)


@pytest.mark.parametrize(("shape", "verdict", "fault"), FAULTS)
@pytest.mark.parametrize("seed", range(3))
def test_each_fault_has_its_verdict(
    shape: Shape, verdict: str, fault: type[PluggingError], seed: int
) -> None:
    judgement = judge_insertion(curve(shape, seed), CONNECTOR)
    assert judgement.verdict == verdict, judgement.checks
    assert isinstance(judgement.fault, fault)
    record = judgement.to_record()
    assert record["fault"] == fault.number
    assert record["verdict"] == verdict


def test_the_moment_points_at_the_bent_contact() -> None:
    for name, position_m in zip(CONNECTOR.contacts, CONNECTOR.positions_m, strict=True):
        if np.linalg.norm(position_m) < 2.2e-3:
            continue
        x_mm, y_mm = position_m * 1e3
        shape = Shape(pin_n_per_mm=115, pin_mm=(float(x_mm), float(y_mm)), noise_n_m=5e-4)
        judgement = judge_insertion(curve(shape), CONNECTOR)
        assert judgement.suspect == name
        assert f"contact {name} of the socket micro-d-15, by moments" in str(judgement.fault)
        assert judgement.to_record()["axes"] == "socket micro-d-15"


def test_a_seat_that_was_not_felt_is_not_measured() -> None:
    good = curve()
    judgement = judge_insertion(replace(good, force_n=good.force_n / 4.448), CONNECTOR)
    assert judgement.verdict is InsertionVerdict.SHORT
    assert judgement.features.seat_depth_m is None
    words = str(judgement.fault)
    assert "distance from the seat's depth not measured (≤ 0.15 mm)" in words
    assert "no seat was felt" in words
    assert "greatest force 8.05 N, deepest point 2.566 mm" in words
    assert "another unit" in PlugShortSeat.cause
    (seat,) = (
        limit
        for limit in judgement.to_record()["limits"]
        if limit["name"] == "distance from the seat's depth"
    )
    assert seat["value"] is None
    assert not seat["passed"]
    assert json.loads(json.dumps(judgement.to_record(), allow_nan=False))
    felt = judge_insertion(curve(Shape(seat_mm=2.2)), CONNECTOR)
    assert "no seat" not in str(felt.fault)


def test_a_missing_contact_is_not_seen_and_that_is_stated() -> None:
    """Lots differ by more than six to one, so 14 of 15 contacts are a good plug."""
    assert judge_insertion(curve(replace(GOOD, peak_n=24 * 14 / 15)), CONNECTOR).fault is None


def watch(shape: Shape, seed: int = 1) -> InsertionWatch:
    found = InsertionWatch(LIMITS)
    for sample in curve(shape, seed):
        if found.feed(sample) is not None:
            break
    return found


@pytest.mark.parametrize("seed", range(5))
def test_a_good_insertion_trips_nothing(seed: int) -> None:
    assert watch(GOOD, seed).trip is None


def test_a_standing_pin_is_stopped_within_a_tenth_of_a_millimetre() -> None:
    trip = watch(Shape(pin_n_per_mm=115, pin_mm=(-4.4, 0.5))).trip
    assert trip is not None
    assert trip.cause is TripCause.AXIAL_EARLY
    assert trip.phase is InsertionPhase.ENTRY
    # The curve was taken at 0.4 mm/s: with 250 ms until it stands 0.1 mm more, below 0.15 mm.
    assert 0.0 < trip.depth_m < 0.05e-3


def test_a_hose_that_pulls_steadily_is_no_contact() -> None:
    assert watch(replace(GOOD, drift_n=1.3)).trip is None
    trip = watch(replace(GOOD, drift_n=3.2)).trip
    assert trip is not None
    assert trip.phase is InsertionPhase.ABOVE


@pytest.mark.parametrize(
    ("shape", "cause"),
    [
        (Shape(side_n=2.5, axial_per_side=0.0), TripCause.SIDE),
        (Shape(moment_z_n_m=0.05), TripCause.MOMENT),
        (Shape(peak_n=60), TripCause.OVER),
        (Shape(noise_n=float("nan")), TripCause.AXIAL_EARLY),
    ],
)
def test_other_bounds_trip_too(shape: Shape, cause: TripCause) -> None:
    trip = watch(shape).trip
    assert trip is not None
    assert trip.cause is cause


D_SUB = read_connector(Path("config/connectors/d-sub-15-holes.toml"))


def test_the_bounds_are_those_of_the_drawing() -> None:
    long = InsertionLimits.of(D_SUB)
    assert LIMITS.entry_axial_n == pytest.approx(1.2)
    assert long.entry_axial_n == pytest.approx(1.8), "its funnels take half as much again"
    # A side force on the contact that is farthest out: 4.5 and 9.8 mm.
    assert LIMITS.at(0.0).moment_z_n_m == pytest.approx(0.008, rel=0.03)
    assert LIMITS.at(2e-3).moment_z_n_m == pytest.approx(0.02, rel=0.03)
    assert long.at(0.0).moment_z_n_m == pytest.approx(0.017, rel=0.03)
    # A short connector has the bound that the tilt of a long one needs only at the springs' begin.
    assert {LIMITS.at(depth).centre_of_pressure_m for depth in (0.5e-3, 1e-3, 2.4e-3)} == {1e-3}
    opening = [long.at(1e-3 + way).centre_of_pressure_m for way in (0.1e-3, 0.2e-3, 0.5e-3, 3e-3)]
    assert opening == sorted(opening, reverse=True)
    assert opening[0] > 3e-3
    assert opening[-1] < 1.3e-3


def test_a_plug_that_presses_at_its_end_is_refused() -> None:
    """What lies under one end of a long connector, once its springs are open."""
    good = curve(Shape(spring_mm=1.0, seat_mm=4.5))
    assert judge_insertion(good, D_SUB).verdict is InsertionVerdict.SEATED
    beside = good.moment_n_m.copy()
    beside[good.depth_m > 2e-3, 1] -= 0.002 * good.force_n[good.depth_m > 2e-3, 2]
    judged = judge_insertion(replace(good, moment_n_m=beside), D_SUB)
    assert judged.verdict is InsertionVerdict.SIDE
    assert judged.features.pressure_m > judged.features.pressure_limit_m
    assert "centre of pressure" in str(judged.fault)


def test_limits_follow_depth() -> None:
    assert LIMITS.at(-1e-3).speed_m_s == 5e-3
    assert LIMITS.at(0.0).speed_m_s == 0.07e-3
    assert LIMITS.at(2e-3).speed_m_s == 0.4e-3
    assert LIMITS.at(0.0).side_n < LIMITS.at(2e-3).side_n
    assert LIMITS.at(2e-3).axial_n == pytest.approx(51.7)
