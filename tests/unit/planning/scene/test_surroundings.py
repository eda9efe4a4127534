from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.planning.scene.cell_scene import Standpoint
from cellctl.planning.ways.sweep import sweep
from tests.rigs.mujoco_oracle import MujocoOracle
from tests.unit.planning.deck_cell import deck_scene

SCENE = deck_scene()


def at(robot: str, pose: str) -> Standpoint:
    return Standpoint(pose, tuple(SCENE.arms[robot].taught_rad(pose)))


def test_links_end_where_the_driver_puts_the_flange() -> None:
    rng = np.random.default_rng(1)
    arm = SCENE.arms["aux_1"]
    for _ in range(20):
        joints_rad = rng.uniform(-3.0, 3.0, 6)
        cell_T_flange = RigidTransform.from_matrix(arm.link_frames(joints_rad)[6])
        expected = arm.cell_T_base * arm.base_T_flange(joints_rad)
        assert np.allclose(cell_T_flange.as_matrix(), expected.as_matrix(), atol=1e-12)


def test_distances_are_those_of_another_library() -> None:
    rng = np.random.default_rng(2)
    oracle = MujocoOracle(SCENE)
    others = {"aux_1": [at("aux_1", "measuring")], "aux_2": [at("aux_2", "retracted")]}
    standing = {name: np.array(places[0].joints_rad) for name, places in others.items()}
    around = SCENE.around("main", others)
    lower, upper = SCENE.arms["main"].chain.lower_rad, SCENE.arms["main"].chain.upper_rad
    compared = 0
    for _ in range(150):
        joints_rad = rng.uniform(lower, upper)
        found = around.narrowest(joints_rad)
        expected_m = oracle.narrowest_slack_m("main", {**standing, "main": joints_rad})
        if expected_m < 0.001:
            assert found.slack_m < 0.002
            continue
        compared += 1
        assert found.slack_m == pytest.approx(expected_m, abs=5e-4)
    assert compared > 20


def test_no_body_is_farther_from_an_axis_than_its_lever() -> None:
    """Turned by one joint alone, no body may move further than the lever allows."""
    rng = np.random.default_rng(3)
    lever_m = SCENE.around("main", {}).lever_m
    for _ in range(50):
        start, joint, turn = rng.uniform(-2.0, 2.0, 6), rng.integers(6), 0.01
        end = start.copy()
        end[joint] += turn
        before = SCENE.placed({"main": start})
        after = SCENE.placed({"main": end})
        for (solid, first), (_, second) in zip(before, after, strict=True):
            if solid.arm == "main":
                corners = np.c_[
                    solid.shape.mesh().vertices, np.ones(len(solid.shape.mesh().vertices))
                ]
                moved = np.linalg.norm((corners @ first.T - corners @ second.T)[:, :3], axis=1)
                assert moved.max() <= lever_m[joint] * turn * (1 + 1e-6)


def test_links_of_one_arm_that_meet_have_no_room() -> None:
    """Between them no margin is asked for, so that nothing but the meeting itself tells."""
    folded_rad = np.radians([0.0, -90.0, 144.0, 0.0, 120.0, 90.0])
    around = SCENE.around("main", {})
    assert not around.has_room(folded_rad, 0.0)
    found = around.narrowest(folded_rad)
    assert found.slack_m < 0.0
    assert {found.first, found.second} == {"main.upper_arm", "main.deck"}
    assert MujocoOracle(SCENE).narrowest_slack_m("main", {"main": folded_rad}) < 0.0
    assert sweep(around, np.vstack([folded_rad, folded_rad])).gap.slack_m < 0.0


def test_bodies_without_margins_may_not_meet_either() -> None:
    solids = tuple(replace(solid, margin_m=0.0) for solid in SCENE.solids)
    around = replace(SCENE, solids=solids).around("main", {})
    low_rad = np.radians([0.0, 20.0, 144.0, 0.0, 90.0, 90.0])
    assert around.narrowest(low_rad).slack_m < 0.0
    assert not around.has_room(low_rad, 0.0)


def test_an_approach_lets_two_bodies_come_near() -> None:
    seat = np.radians([0.0, -50.0, 110.0, 0.0, 30.0, 90.0])
    low = SCENE.around("main", {}).narrowest(seat)
    assert {low.first, low.second} == {"main.deck", "frame"}
    near = SCENE.around("main", {}, approach=True).narrowest(seat)
    assert {near.first, near.second} != {"main.deck", "frame"}
