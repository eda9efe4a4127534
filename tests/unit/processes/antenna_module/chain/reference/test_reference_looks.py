"""A few looks find what has moved, more of them where a few leave it in doubt."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.reference.reference_check import (
    ReferenceReading,
    further_looks,
    require_nothing_moved,
)
from cellctl.processes.antenna_module.chain.reference.reference_looks import turn_angles
from cellctl.processes.antenna_module.chain.teaching.tool_turn import TurnStop, calibrate_tool_turn
from cellctl.processes.antenna_module.faults.calibration import (
    ArmMoved,
    FixedCameraMoved,
    FlangeCameraMoved,
    GripperMarksMoved,
    ReferenceMoved,
    ReferencePlateMoved,
)
from tests.unit.processes.antenna_module.chain.reference_draws import (
    ARM,
    OFFSET_M,
    drawn_looks,
)

COUNT, TAUGHT_COUNT = 4, 16
D = 20e-6 * np.array([np.cos(0.7), np.sin(0.7)])


def verdict(seed: int, moved: Mapping[str, Array]) -> tuple[type[ReferenceMoved] | None, int]:
    """The fault of one check as step 10 makes it, and how many looks it took."""
    rng = np.random.default_rng(seed)
    taught = drawn_looks(TAUGHT_COUNT, rng).reading(ARM)
    looks = drawn_looks(COUNT, rng, **moved)
    while more := further_looks(
        taught, looks.reading(ARM), first=COUNT, taken=len(looks.plate_in_camera_1)
    ):
        looks += drawn_looks(more, rng, **moved)
    try:
        require_nothing_moved(taught, looks.reading(ARM), ARM.drift_m)
    except ReferenceMoved as fault:
        return type(fault), len(looks.turns)
    return None, len(looks.turns)


@pytest.mark.parametrize("count", [4, 8, 12])
def test_angles_are_a_turn_that_can_be_used(count: int) -> None:
    angles = turn_angles(count)
    assert len(set(angles)) == count
    turned = [
        TurnStop(angle, np.array([np.cos(angle), np.sin(angle)]) * 0.2e-3) for angle in angles
    ]
    result = calibrate_tool_turn(turned)
    np.testing.assert_allclose(result.axis_m, [0, 0], atol=1e-12)
    np.testing.assert_allclose(result.offset_m, [0.2e-3, 0], atol=1e-12)


def test_the_reading_has_every_place() -> None:
    looks = drawn_looks(TAUGHT_COUNT, np.random.default_rng(1), axis=D, plate_1=2 * D, plate_2=-D)
    reading = looks.reading(ARM)
    for found, true in (
        (reading.axis_in_camera_2, D),
        (reading.marks_from_axis, OFFSET_M),
        (reading.plate_in_camera_1, 2 * D),
        (reading.plate_in_camera_2, -D),
    ):
        np.testing.assert_allclose(found, true, atol=4 * reading.sigma_m)
    assert reading.sigma_m == pytest.approx(6.94e-6 / np.sqrt(TAUGHT_COUNT), rel=0.02)
    assert all(check.passed for check in looks.checks(ARM))


def test_an_arm_that_repeats_badly_makes_no_reference() -> None:
    bad = replace(
        ARM,
        repeatability_m=2.5 * ARM.repeatability_m,
        repeatability_rad=2.5 * ARM.repeatability_rad,
    )
    checks = drawn_looks(TAUGHT_COUNT, np.random.default_rng(1)).checks(bad)
    assert [check.name for check in checks if not check.passed] == ["sigma of a place"]


def test_the_noise_of_the_arm_alone_is_no_fault_and_seldom_in_doubt() -> None:
    found = [verdict(seed, {}) for seed in range(200)]
    assert sum(fault is not None for fault, _ in found) == 0
    assert np.mean([looks > COUNT for _, looks in found]) < 0.25


@pytest.mark.parametrize(
    ("moved", "fault"),
    [
        ({"axis": -D, "plate_2": -D}, FixedCameraMoved),
        ({"marks": D}, GripperMarksMoved),
        ({"plate_1": D, "plate_2": D}, ReferencePlateMoved),
        ({"plate_1": -D}, FlangeCameraMoved),
    ],
)
@pytest.mark.figures
def test_20_um_are_found_and_the_device_is_named(
    moved: Mapping[str, Array], fault: type[ReferenceMoved]
) -> None:
    found = [verdict(seed, moved)[0] for seed in range(400)]
    assert np.mean([one is not None for one in found]) >= 0.995
    assert np.mean([one is fault for one in found]) >= 0.95


def test_each_device_that_has_moved_far_is_named() -> None:
    far = 3 * D
    for moved, fault in (
        ({"axis": -far, "plate_2": -far}, FixedCameraMoved),
        ({"marks": far}, GripperMarksMoved),
        ({"plate_1": far, "plate_2": far}, ReferencePlateMoved),
        ({"plate_1": -far}, FlangeCameraMoved),
    ):
        assert verdict(1, moved)[0] is fault


def test_what_is_far_off_is_looked_at_once_more_and_what_is_near_the_limit_twice() -> None:
    _, far = verdict(1, {"marks": 5 * D})
    _, near = verdict(1, {"marks": D})
    assert (far, near) == (2 * COUNT, 4 * COUNT)


def test_an_arm_that_warms_up_is_no_fault_and_one_that_was_hit_is() -> None:
    none = np.zeros(2)
    taught = ReferenceReading(none, none, none, none, sigma_m=2e-6)

    def after(drift_m: float) -> ReferenceReading:
        along = np.array([drift_m, 0.0])
        return ReferenceReading(along, none, -along, none, sigma_m=3e-6)

    assert require_nothing_moved(taught, after(5e-6), ARM.drift_m) is None
    warmed = require_nothing_moved(taught, after(60e-6), ARM.drift_m)
    assert isinstance(warmed, ArmMoved)
    with pytest.raises(ArmMoved):
        require_nothing_moved(taught, after(80e-6), ARM.drift_m)
