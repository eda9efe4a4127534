import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cellctl.errors.force import PosesDegenerate, TooFewPoses
from cellctl.force.gravity.excitation import excitation, require_excitation
from cellctl.force.gravity.payload import fit_affine24, fit_rigid12
from tests.rigs.payload_world import MATING, cone, rotations


def test_condition_numbers_are_those_of_the_reference_table() -> None:
    ten = excitation(rotations(cone(half_angle_deg=10.0, fit_poses=17)))
    fifteen = excitation(rotations(cone(half_angle_deg=15.0, fit_poses=17)))
    assert 18.0 < ten.condition_rigid12 < 30.0
    assert 12.0 < fifteen.condition_rigid12 < 20.0
    assert 250.0 < ten.condition_affine24 < 600.0
    assert fifteen.condition_affine24 < ten.condition_affine24


def test_one_pose_many_times_is_refused() -> None:
    same = Rotation.concatenate([MATING.rotation] * 12)
    with pytest.raises(PosesDegenerate, match="same way"):
        require_excitation(same, "affine24")


def test_turning_about_the_vertical_is_refused() -> None:
    turns = Rotation.from_euler("z", np.linspace(0.0, 6.0, 12)[:, None]) * MATING.rotation
    with pytest.raises(PosesDegenerate, match="vertical"):
        require_excitation(turns, "affine24")


def test_tilting_about_one_axis_is_refused_and_the_direction_named() -> None:
    tilts = Rotation.from_euler("x", np.linspace(-0.3, 0.3, 15)[:, None]) * MATING.rotation
    with pytest.raises(PosesDegenerate, match=r"one axis only.*"):
        require_excitation(tilts, "affine24")


def test_a_narrow_cone_is_refused() -> None:
    with pytest.raises(PosesDegenerate, match="only"):
        require_excitation(rotations(cone(half_angle_deg=2.0)), "affine24")


@pytest.mark.parametrize(("method", "count"), [("rigid12", 3), ("affine24", 5)])
def test_too_few_poses_are_refused(method: str, count: int) -> None:
    few = rotations(cone())[:count]
    with pytest.raises(TooFewPoses, match=method):
        require_excitation(few, method)


def test_the_fits_refuse_by_themselves() -> None:
    few = rotations(cone())[:3]
    with pytest.raises(TooFewPoses):
        fit_rigid12(few, np.zeros((3, 6)))
    with pytest.raises(TooFewPoses):
        fit_affine24(few, np.zeros((3, 6)))
