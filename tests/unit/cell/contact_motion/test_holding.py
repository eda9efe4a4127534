"""Work that is done while the arm stands in its stream."""

import asyncio

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.streamed_contact import HeldTooLong
from cellctl.interfaces import StreamReport
from tests.unit.cell.contact_motion.elastic_world import (
    FRAMES,
    ElasticWorld,
    WorldStream,
    contact,
)


class ReadyStream(WorldStream):
    """Its ticks are all there already: nothing in it ever waits."""

    async def advance(self, base_T_flange: RigidTransform) -> StreamReport:
        self._world.tick(FRAMES.tip(base_T_flange))
        self._tick += 1
        return self.report


def ready_world() -> ElasticWorld:
    world = ElasticWorld(lambda _tip: np.zeros(6))
    world.stream = ReadyStream(world)
    return world


async def test_the_work_gets_its_turn_beside_a_stream_that_never_waits() -> None:
    world, done = ready_world(), asyncio.Event()

    async def work() -> None:
        asyncio.get_running_loop().call_later(0.02, done.set)
        await done.wait()

    sent = len(world.sent)
    await contact(world).hold_while(work())
    assert done.is_set()
    assert len(world.sent) > sent + 1, "the arm stood in its stream meanwhile"


async def test_work_that_does_not_end_is_a_fault() -> None:
    given_up = asyncio.Event()

    async def work() -> None:
        try:
            await asyncio.Event().wait()
        finally:
            given_up.set()

    with pytest.raises(HeldTooLong):
        await contact(ready_world()).hold_while(work(), limit_s=0.05)
    assert given_up.is_set()


async def test_a_fault_of_the_work_is_that_of_the_motion() -> None:
    async def work() -> None:
        raise ValueError("disk")

    with pytest.raises(ValueError, match="disk"):
        await contact(ready_world()).hold_while(work())
