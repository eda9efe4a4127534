"""The contract of the stop channel: in memory, and the SIASUN driver on its fake controller."""

from collections.abc import Callable, Iterator
from contextlib import AbstractAsyncContextManager, AsyncExitStack
from typing import ClassVar

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.interfaces.stop_channel import StopChannel
from drivers.robot.siasun.stop_channel import SiasunStopChannel
from tests.contracts.inprocess.stop_channel import FLANGE, InProcessStopChannel
from tests.contracts.loop_thread import LoopThread
from tests.contracts.suites.stop_channel import StopBench, StopChannelContract
from tests.rigs.wire.job_rig import JobRig, job_rig
from tests.rigs.wire.sjl_rig import Rig, sjl_rig
from tests.rigs.wire.standing_arm import TURNED_DEG


class InProcessBench(StopBench):
    def __init__(self) -> None:
        self.memory = InProcessStopChannel()
        self.channel: StopChannel = self.memory

    def start_motion(self) -> None:
        self.memory.start_motion()

    def moving(self) -> bool:
        return self.memory.moving()

    def flange(self) -> RigidTransform:
        return FLANGE

    def flood(self) -> None:
        """Nothing is read from anywhere."""

    def cut(self) -> None:
        self.memory.lost = True


class SiasunBench(StopBench):
    def __init__(self, thread: LoopThread, rig: Rig | JobRig) -> None:
        self._thread = thread
        self._rig = rig
        self.channel: StopChannel = SiasunStopChannel(rig.guard)
        thread.call(rig.controller.start)

    def start_motion(self) -> None:
        def begin() -> None:
            target = np.radians([30.0, *TURNED_DEG[1:]])
            self._rig.arm.start_joint(self._rig.controller._clock(), target, 10.0)

        self._thread.call(self._rig.turn if isinstance(self._rig, JobRig) else begin)

    def moving(self) -> bool:
        return self._thread.call(lambda: self._rig.arm.moving(self._rig.controller._clock()))

    def flange(self) -> RigidTransform:
        return self._thread.call(lambda: self._rig.arm.encoder_pose(self._rig.controller._clock()))

    def flood(self) -> None:
        self._rig.wires["GRD"].back.repeat_next = 20_000

    def cut(self) -> None:
        self._thread.call(self._rig.wires["GRD"].reset)


class TestInProcessStopChannel(StopChannelContract):
    @pytest.fixture
    def bench(self) -> Iterator[StopBench]:
        bench = InProcessBench()
        yield bench
        bench.channel.close()


class TestSiasunStopChannel(StopChannelContract):
    driver = SiasunStopChannel
    rig: ClassVar[Callable[..., AbstractAsyncContextManager[Rig | JobRig]]] = staticmethod(sjl_rig)
    """Makes the other end."""

    @pytest.fixture
    def bench(self) -> Iterator[StopBench]:
        with LoopThread() as thread:
            stack = AsyncExitStack()
            rig = thread.run(
                stack.enter_async_context(self.rig(channels=("GRD",), stands_deg=TURNED_DEG))
            )
            bench = SiasunBench(thread, rig)
            yield bench
            bench.channel.close()
            thread.run(stack.aclose())


class TestSiasunStopChannelOnItsJobs(TestSiasunStopChannel):
    """The same channel, with the shipped job files at the other end."""

    rig = staticmethod(job_rig)
