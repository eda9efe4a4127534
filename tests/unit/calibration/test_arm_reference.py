import json

import numpy as np
import pytest

from cellctl.calibration.arm_reference import (
    ArmReference,
    require_arm_at_reference,
    target_offsets,
)
from cellctl.errors.robot import ArmOffReference, ArmReferenceMissing
from cellctl.interfaces import Target

SIGMA_M = 2e-5
PLACES_M = np.random.default_rng(3).uniform([1.8, 0.3, 0.8], [2.2, 0.7, 1.2], (6, 3))


def look(offsets_m: np.ndarray | float = 0.0, names: str = "ABCDEF") -> ArmReference:
    places = PLACES_M + offsets_m
    seen = zip(names, places, strict=False)
    targets = tuple(Target(f"F{name}", place, SIGMA_M) for name, place in seen)
    return ArmReference(np.radians([0.0, -75.0, 120.0, 0.0, 45.0, 90.0]), targets)


def test_it_survives_its_record() -> None:
    then = look()
    again = ArmReference.from_record(json.loads(json.dumps(then.to_record())))
    assert require_arm_at_reference(target_offsets(then, again)) < 1e-12
    np.testing.assert_allclose(again.joints_rad, then.joints_rad)


def test_noise_is_no_move() -> None:
    rng = np.random.default_rng(1)
    for _ in range(300):
        noise = rng.normal(0.0, SIGMA_M, (2, 6, 3)) + rng.normal(0.0, 2e-5, (2, 1, 3))
        assert require_arm_at_reference(target_offsets(look(noise[0]), look(noise[1]))) < 0.2e-3


def test_warmth_is_no_move() -> None:
    """60 µm along each axis and 60 µrad about both level ones: 5 K in a base of steel."""
    warmed_m = np.array([-60e-6, -60e-6, 60e-6]) + np.cross([60e-6, -60e-6, 0.0], PLACES_M)
    assert 0.2e-3 < require_arm_at_reference(target_offsets(look(), look(warmed_m))) < 0.3e-3


def test_a_turn_about_the_first_axis_is_found() -> None:
    """0.01 degrees at 2 m are 0.36 mm."""
    turn_rad = np.radians(0.01)
    aside_m = turn_rad * np.column_stack([-PLACES_M[:, 1], PLACES_M[:, 0], np.zeros(6)])
    with pytest.raises(ArmOffReference, match=r"F[A-F] 0\.3\d\d mm off, at most 0\.300 mm"):
        require_arm_at_reference(target_offsets(look(), look(aside_m)))


def test_one_target_that_was_touched_is_found() -> None:
    offsets_m = np.zeros((6, 3))
    offsets_m[2, 1] = 0.5e-3
    with pytest.raises(ArmOffReference, match="FC"):
        require_arm_at_reference(target_offsets(look(), look(offsets_m)))


def test_a_place_that_is_not_a_number_is_off() -> None:
    with pytest.raises(ArmOffReference):
        require_arm_at_reference(target_offsets(look(), look(np.full((6, 3), np.nan))))


def test_an_uncertain_look_is_not_taken_for_a_move() -> None:
    vague = tuple(Target(one.name, one.position_m, 1e-3) for one in look(0.5e-3).targets)
    assert (
        require_arm_at_reference(target_offsets(look(), ArmReference(np.zeros(6), vague))) > 0.5e-3
    )


def test_two_targets_are_too_few() -> None:
    with pytest.raises(ArmReferenceMissing, match="FA, FB"):
        require_arm_at_reference(target_offsets(look(), look(names="AB")))
    with pytest.raises(ArmReferenceMissing, match="none"):
        require_arm_at_reference(target_offsets(look(), look(names="UVWXYZ")))
