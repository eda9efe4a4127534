import math

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.arm.linear_way import (
    SINGULAR,
    BrokenWay,
    WaySteps,
    linear_joint_way,
    nearness_to_singular,
)
from tests.unit.planning.deck_cell import deck_scene

ARM = deck_scene().arms["main"]
CHAIN = ARM.chain
COARSE = WaySteps(0.05, math.radians(10.0), jump_rad=math.radians(45.0), at_most=10)
FINE = WaySteps(0.005, math.radians(0.5), jump_rad=math.radians(20.0))
READY_RAD = ARM.taught_rad("deck_measure")


def shifted(joints_rad: np.ndarray, way_m: list[float]) -> RigidTransform:
    """The flange's pose at joints, moved along the base."""
    return RigidTransform.from_translation(way_m) * CHAIN.base_T_flange(joints_rad)


@pytest.mark.parametrize("steps", [COARSE, FINE])
def test_the_flange_lies_on_the_straight_line_all_the_way(steps: WaySteps) -> None:
    begin = CHAIN.base_T_flange(READY_RAD)
    end = shifted(READY_RAD, [0.1, 0.2, -0.1]) * RigidTransform.from_rotation(
        Rotation.from_rotvec([0.0, 0.3, 0.0])
    )
    way = linear_joint_way(CHAIN, READY_RAD, end, steps)
    assert not isinstance(way, BrokenWay)
    assert len(way) > 3
    line = end.translation - begin.translation
    for share, joints_rad in zip(np.linspace(0.0, 1.0, len(way)), way, strict=True):
        flange = CHAIN.base_T_flange(joints_rad)
        np.testing.assert_allclose(flange.translation, begin.translation + share * line, atol=1e-8)
        turned_rad = (begin.rotation.inv() * flange.rotation).magnitude()
        assert turned_rad == pytest.approx(0.3 * share, abs=1e-8)


def test_a_long_way_is_looked_at_in_no_more_than_the_allowed_points() -> None:
    way = linear_joint_way(CHAIN, READY_RAD, shifted(READY_RAD, [0.0, 0.6, 0.0]), COARSE)
    assert not isinstance(way, BrokenWay)
    assert len(way) == 11


def test_a_way_ends_where_the_reach_of_the_arm_ends() -> None:
    broken = linear_joint_way(CHAIN, READY_RAD, shifted(READY_RAD, [2.5, 0.0, 0.0]), FINE)
    assert isinstance(broken, BrokenWay)
    assert 0.0 < broken.share < 1.0


@pytest.mark.parametrize("steps", [COARSE, FINE])
def test_a_way_through_a_straight_wrist_is_broken(steps: WaySteps) -> None:
    """Both ends are good poses, on either side of the wrist's singular pose."""
    start_rad = np.radians([0.0, -90.0, 90.0, 0.0, 12.0, 90.0])
    end_rad = np.radians([0.0, -90.0, 90.0, 0.0, -12.0, 90.0])
    assert nearness_to_singular(CHAIN, start_rad)[0] > 3 * SINGULAR
    broken = linear_joint_way(CHAIN, start_rad, CHAIN.base_T_flange(end_rad), steps)
    assert isinstance(broken, BrokenWay)
    assert "singular" in broken.why or "fold" in broken.why


def test_near_a_straight_wrist_on_the_way_beside_it() -> None:
    """A4 would have to turn by nearly half a turn while the flange goes past."""
    start_rad = np.radians([0.0, -90.0, 90.0, 3.0, 20.0, 90.0])
    end_rad = np.radians([0.0, -90.0, 90.0, 177.0, 20.0, -90.0])
    end = CHAIN.base_T_flange(end_rad)
    for steps in (COARSE, FINE):
        assert isinstance(linear_joint_way(CHAIN, start_rad, end, steps), BrokenWay)


def test_the_nearness_tells_the_sides_apart() -> None:
    values = {}
    for wrist_deg in (-5.0, -1.0, 1.0, 5.0):
        joints_rad = np.radians([0.0, -90.0, 90.0, 0.0, wrist_deg, 90.0])
        values[wrist_deg] = nearness_to_singular(CHAIN, joints_rad)
    assert values[1.0][0] < SINGULAR < values[5.0][0]
    assert values[-1.0][1] == -values[1.0][1] != 0.0
    assert values[-5.0][0] == pytest.approx(values[5.0][0], rel=0.1)
