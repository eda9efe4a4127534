"""Straight moves that an arm cannot follow are refused before anything is sent."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.moves import MoveKind
from cellctl.errors.robot import WayNotReached
from cellctl.planning.ways.polyline import joints_at
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.stated_moves import deck_moves
from drivers.robot.siasun.bounds import LINEAR_STEPS, Bounds
from drivers.robot.siasun.config import SiasunConfig
from tests.rigs.shipped import shipped_cell
from tests.rigs.wire.sjl_rig import sjl_rig
from tests.rigs.wire.standing_arm import READY_DEG
from tests.unit.planning.deck_cell import DECK, deck_scene
from tests.wire.siasun.test_siasun_kinematics import chain_of, config_of, standing_at

READY_RAD = np.radians(READY_DEG)


def settings(**changes: object) -> SiasunConfig:
    return config_of("main").model_copy(update=changes)


def check(
    way_m: list[float], config: SiasunConfig | None = None, start_rad: np.ndarray = READY_RAD
) -> None:
    """A straight move along the base from where the arm stands."""
    config = config or settings()
    here = chain_of("main").base_T_flange(start_rad)
    target = RigidTransform.from_translation(way_m) * here
    Bounds("main", config).linear_way(standing_at(start_rad, here), target)


def test_out_of_reach() -> None:
    with pytest.raises(WayNotReached, match=r"main: to \[4\d\d\d"):
        check([2.6, 0.0, 0.0])
    check([0.2, 0.0, 0.0])


def test_a_joint_beyond_its_limit_in_the_middle_of_the_way() -> None:
    """The flange goes past the base, so that A2 and A3 are farthest back in the middle."""
    start_rad = READY_RAD + np.radians([12.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    y_m = float(chain_of("main").base_T_flange(start_rad).translation[1])
    past = [0.0, -2.0 * y_m, 0.0]
    upper = list(settings().joints_max_deg)
    check(past, start_rad=start_rad)
    upper[2] = READY_DEG[2] + 1.0
    with pytest.raises(WayNotReached, match=r"allowed .* [1-9]\d% of the way"):
        check(past, settings(joints_max_deg=tuple(upper)), start_rad)


def test_a_way_back_from_beyond_a_limit_is_free() -> None:
    upper = list(settings().joints_max_deg)
    upper[2] = READY_DEG[2] - 0.5
    beyond = settings(joints_max_deg=tuple(upper))
    check([0.2, 0.0, 0.0], beyond)
    with pytest.raises(WayNotReached):
        check([-0.2, 0.0, 0.0], beyond)


def test_a_singular_wrist() -> None:
    start_rad = np.radians([0.0, -90.0, 90.0, 0.0, 1.0, 90.0])
    with pytest.raises(WayNotReached, match="singular"):
        check([0.0, 0.0, -0.0002], start_rad=start_rad)


def test_without_a_table_nothing_is_known() -> None:
    config = settings(dh=None)
    here = RigidTransform.identity()
    far = RigidTransform.from_translation([9.0, 0.0, 0.0])
    Bounds("main", config).linear_way(standing_at(READY_RAD, here), far)


def test_every_straight_move_of_the_shipped_cell_is_free() -> None:
    cell, scene = shipped_cell(DECK.name), deck_scene()
    recipes = [recipe for recipe in cell.recipes if isinstance(recipe, DeckRecipe)]
    moves = [move for recipe in recipes for move in deck_moves(cell, recipe)]
    straight = [move for move in moves if move.kind is MoveKind.LINEAR]
    assert len(straight) > 10
    for move in straight:
        arm = scene.arms[move.robot]
        start_rad, end_rad = joints_at(arm, move.start), joints_at(arm, move.end)
        state = standing_at(start_rad, arm.base_T_flange(start_rad))
        bounds = Bounds(move.robot, config_of(move.robot))
        bounds.linear_way(state, arm.base_T_flange(end_rad))


def test_no_way_is_looked_at_in_so_many_points_that_the_event_loop_would_wait() -> None:
    farthest_m, half_a_turn = np.array([5.0, 0.0, 0.0]), np.array([np.pi, 0.0, 0.0])
    assert LINEAR_STEPS.count(farthest_m, half_a_turn) == 8
    assert LINEAR_STEPS.count(0.001 * farthest_m, 0.0 * half_a_turn) == 1


async def test_nothing_is_sent_for_a_way_that_cannot_be_followed() -> None:
    upper = (90.0, 20.0, READY_DEG[2] + 0.02, 180.0, 120.0, 210.0)
    async with sjl_rig(dh=config_of("main").dh, joints_max_deg=upper) as rig:
        await rig.connect()
        here = rig.robot.state().base_T_flange
        back = RigidTransform.from_translation([-0.05, 0.0, 0.0]) * here
        with pytest.raises(WayNotReached):
            await rig.robot.move_linear(back, speed_m_s=0.05, acceleration_m_s2=0.5)
        little = RigidTransform.from_translation([-0.0005, 0.0, 0.0]) * here
        with pytest.raises(WayNotReached):
            await rig.robot.step(little, speed_m_s=0.01)
        assert not rig.arm.moving(rig.controller._clock())
        assert not rig.robot.state().stop_latched
        forth = RigidTransform.from_translation([0.01, 0.0, 0.0]) * here
        await rig.robot.move_linear(forth, speed_m_s=0.05, acceleration_m_s2=0.5)
