"""Many motions of a collaborative arm, each with a random fault: none lost, doubled or resumed."""

import asyncio
import random
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from cellctl.interfaces.robot import RobotState
from tests.wire.duco_moves import stands
from tests.wire.duco_rig import DucoRig, duco_rig

MOVES = 100
END_S = 5.0
"""A motion of at most 20 mm, the loss of its link, and the stop."""


def corrupt(rig: DucoRig, rng: random.Random) -> None:
    """A bit of a reply. A bit of a call may make it another call, of which nobody can know."""
    rig.rpc.back.corrupt_in = rng.randrange(400)


FAULTS: dict[str, Callable[[DucoRig, random.Random], object]] = {
    "none": lambda rig, rng: None,
    "reset": lambda rig, rng: rig.reset(),
    "nothing arrives": lambda rig, rng: setattr(rig.rpc.forth, "blocked", True),
    "nothing comes back": lambda rig, rng: setattr(rig.rpc.back, "blocked", True),
    "corrupt": corrupt,
    "split": lambda rig, rng: setattr(rig.rpc.back, "split", True),
    "delayed": lambda rig, rng: setattr(rig.rpc.back, "delay_s", 0.05),
    "silent": lambda rig, rng: rig.logic.faults.inject("silent"),
    "frames stop": lambda rig, rng: rig.logic.faults.inject("frames_stop"),
    "minus one": lambda rig, rng: rig.logic.faults.inject("minus_one", count=1),
    "key": lambda rig, rng: rig.logic.faults.inject("manual_mode"),
}


def heal(rig: DucoRig) -> None:
    for way in (rig.rpc.forth, rig.rpc.back):
        way.blocked = way.split = False
        way.delay_s, way.corrupt_in = 0.0, None
    rig.logic.faults.clear()


async def rearm(rig: DucoRig) -> None:
    """As an operator does: again until the link is back and the controller accepts."""
    async with asyncio.timeout(12.0):
        while True:
            try:
                await rig.robot.connect()
                return await rig.robot.rearm()
            except CellError:
                await asyncio.sleep(0.05)


async def outcome(job: "asyncio.Task[RobotState]") -> RobotState | None:
    """Where it ended; None for a motion that ended early, which must be soon."""
    async with asyncio.timeout(END_S):
        try:
            return await job
        except CellError:
            return None


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2])
async def test_motions_under_random_faults(seed: int) -> None:
    rng = random.Random(seed)
    async with duco_rig() as rig:
        await rig.robot.connect()
        base_T_flange = rig.robot.state().base_T_flange
        for _ in range(MOVES):
            lift = RigidTransform.from_translation([0.0, 0.0, rng.uniform(-0.01, 0.01)])
            target, before = lift * base_T_flange, rig.logic.motions
            job = asyncio.create_task(
                rig.robot.move_linear(target, speed_m_s=0.1, acceleration_m_s2=1.0)
            )
            await asyncio.sleep(rng.uniform(0.0, 0.2))
            fault = rng.choice(sorted(FAULTS))
            FAULTS[fault](rig, rng)
            end = await outcome(job)
            assert rig.logic.motions - before <= 1, fault
            if end is not None:
                assert not rig.logic.moving(), fault
                flange = rig.arm.encoder_pose(rig.logic.clock())
                assert np.linalg.norm(flange.translation - target.translation) < 1e-4, fault
            await stands(rig)
            begun = rig.logic.motions
            heal(rig)
            await rearm(rig)
            assert rig.logic.motions == begun, fault
