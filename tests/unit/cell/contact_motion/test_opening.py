"""The order in which guard and stream begin and end."""

import asyncio
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import Ended
from cellctl.cell.contact_motion.opening import streamed_contact, watch_closer
from cellctl.cell.contact_motion.settings import ContactSettings
from cellctl.cell.devices import Cell
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance
from cellctl.cell.guarded_motion.kept_zero import KeptZero, Pressed, kept_zero
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.errors.robot import StreamNotOffered
from cellctl.errors.streamed_contact import LoopTooSlow, LoopUnstable
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.guard.client import GuardClient
from cellctl.interfaces import Robot
from tests.contracts.inprocess.robot import InProcessRobot
from tests.contracts.inprocess.streaming_robot import OFFER, InProcessStreamingRobot
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.bench import CELL_FILE
from tests.unit.cell.contact_motion.elastic_world import FRAMES
from tests.unit.cell.guard import TinyGuard


def settings(stiffness_n_m: float = 1e6) -> ContactSettings:
    """A busy machine may be late here: nothing is touched."""
    figures = LoopFigures(stiffness_n_m, 24e-3)
    return ContactSettings(
        figures, 3e-3, 8.0, 50.0, 2.0, lost_tick_s=10.0, old_force_s=1.0, lost_force_s=10.0
    )


def arm_of(robot: Robot, guard: TinyGuard) -> tuple[Cell, GuardedRobot]:
    config = shipped_cell(CELL_FILE.name)
    cell = cast(Cell, SimpleNamespace(trips_awaited=lambda _: nullcontext()))
    sensor = config.force_sensors["force"]
    watching = cast(GuardClient, guard)
    return cell, GuardedRobot(robot, config.robots["main"], "force", watching, sensor)


async def opened(robot: InProcessRobot, guard: TinyGuard, stiffness_n_m: float = 1e6) -> Ended:
    cell, arm = arm_of(robot, guard)
    await robot.connect()
    async with streamed_contact(
        cell, arm, FRAMES, settings(stiffness_n_m), OFFER.limits
    ) as contact:
        assert guard.armed
        assert contact.watched_n == 50.0
        await watch_closer(contact, arm, WrenchTolerance(10.0, 1.0))
        assert contact.watched_n == 10.0
        touched = await contact.touch(np.array([0.0, 0.0, -1.0]), 1e-5, 8.0)
    return touched.ended


def test_the_guard_is_tared_in_the_frame_of_the_tip_and_armed_as_long_as_the_stream_lasts() -> None:
    guard = TinyGuard()
    assert asyncio.run(opened(InProcessStreamingRobot("main"), guard)) is Ended.TRAVEL
    assert guard.asked == ["disarm", "set_wrench_frame", "tare", "arm", "arm", "disarm"]
    assert [limits.filtered[0] for limits in guard.limits] == [50.0, 10.0]
    assert not guard.armed


def test_the_zero_out_of_contact_outlives_the_daemon(tmp_path: Path) -> None:
    async def zero_of_a_loop() -> KeptZero | None:
        robot, guard = InProcessStreamingRobot("main"), TinyGuard()
        cell, arm = arm_of(robot, guard)
        arm = replace(arm, zero_file=tmp_path / "force.json")
        await robot.connect()
        async with streamed_contact(cell, arm, FRAMES, settings(), OFFER.limits):
            pass
        return await kept_zero(arm)

    kept = asyncio.run(zero_of_a_loop())
    assert kept is not None
    assert kept.pressed == Pressed(inwards=1.0, force_n=0.0)


def test_a_robot_without_a_stream_is_told() -> None:
    guard = TinyGuard()
    with pytest.raises(StreamNotOffered, match="main follows no stream"):
        asyncio.run(opened(InProcessRobot("main"), guard))
    assert guard.asked == []


def test_a_force_limit_that_giving_way_would_pass_is_refused() -> None:
    with pytest.raises(LoopUnstable, match=r"more than half of the limit of 8 N"):
        ContactSettings(LoopFigures(1e6, 24e-3), 3e-3, 8.0, limit_n=8.0, limit_n_m=2.0).check()


def test_a_loop_that_is_too_slow_is_refused_before_anything_is_done() -> None:
    guard = TinyGuard()
    with pytest.raises(LoopTooSlow):
        asyncio.run(opened(InProcessStreamingRobot("main"), guard, 1e7))
    assert guard.asked == []
