"""Tilt and turn of a peg from its pose, there and back."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.world.peg.attitude import axis_of, pose_of
from tests.rigs.sweeps import examples

_TILT = st.floats(-0.6, 0.6)


@settings(max_examples=examples(100), deadline=None)
@given(_TILT, _TILT, st.floats(-3.0, 3.0))
def test_a_pose_is_its_turn_and_then_its_tilt(x: float, y: float, turn: float) -> None:
    rotation = Rotation.from_rotvec([x, y, 0.0]) * Rotation.from_rotvec([0.0, 0.0, turn])
    pose = pose_of(RigidTransform.from_components([1.0, 2.0, 3.0], rotation).as_matrix())
    assert pose == pytest.approx((1.0, 2.0, 3.0, x, y, turn), abs=1e-9)
    np.testing.assert_allclose(axis_of(x, y), rotation.apply([0.0, 0.0, 1.0]), atol=1e-12)


def test_an_upright_peg_has_no_tilt() -> None:
    assert pose_of(np.eye(4)) == (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert math.hypot(*axis_of(0.0, 0.0)[:2]) == 0.0
