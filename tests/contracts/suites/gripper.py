"""What every gripper must do."""

import asyncio
from abc import ABC, abstractmethod

import pytest

from cellctl.clock import now_s
from cellctl.errors.gripper import (
    GripperNotClosed,
    GripperNotOpened,
    GripperSensorsDisagree,
    NoPartGripped,
    PartLost,
)
from cellctl.errors.link import LinkError
from cellctl.interfaces.gripper import Gripper


class GripperBench(ABC):
    """A gripper under test, not connected, open, with a part between its jaws."""

    gripper: Gripper

    @abstractmethod
    def take_part(self) -> None:
        """The part is gone from now on."""

    @abstractmethod
    def jam(self) -> None:
        """The jaws do not move from now on."""

    @abstractmethod
    def break_sensor(self) -> None:
        """The sensor of the open position shows open for ever."""

    @abstractmethod
    def travels(self) -> int:
        """How often the jaws have begun to move."""

    @abstractmethod
    def shut(self) -> bool:
        """Whether the jaws have closed, whatever the driver says."""

    @abstractmethod
    def silence(self) -> None:
        """The device answers nothing until ``restore``; the link stands."""

    @abstractmethod
    def restore(self) -> None:
        """End ``silence``."""

    @abstractmethod
    def cut(self) -> None:
        """The link breaks. The gripper can be connected to again."""


async def until_faulty(bench: GripperBench, limit_s: float = 5.0) -> None:
    """Wait until the driver has seen the end of the link, which may take a call or two."""
    async with asyncio.timeout(limit_s):
        while True:
            try:
                await bench.gripper.state()
            except LinkError:
                return
            await asyncio.sleep(0.01)


class GripperContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    async def bench(self) -> GripperBench:
        """A fresh bench, torn down after the test."""

    # --- connecting

    async def test_connecting_is_idempotent_and_moves_nothing(self, bench: GripperBench) -> None:
        await bench.gripper.connect()
        await bench.gripper.connect()
        assert bench.travels() == 0

    async def test_disconnect_in_any_state(self, bench: GripperBench) -> None:
        await bench.gripper.disconnect()
        await bench.gripper.connect()
        await bench.gripper.disconnect()
        await bench.gripper.disconnect()
        for call in (bench.gripper.state, bench.gripper.open, bench.gripper.close):
            with pytest.raises(LinkError):
                await call()
        assert bench.travels() == 0

    async def test_letting_go_moves_nothing(self, bench: GripperBench) -> None:
        await bench.gripper.let_go()
        await bench.gripper.connect()
        await bench.gripper.close()
        before = bench.travels()
        await bench.gripper.let_go()
        assert bench.shut()
        with pytest.raises(LinkError):
            await bench.gripper.state()
        await bench.gripper.connect()
        await bench.gripper.confirm_part()
        assert bench.travels() == before

    async def test_the_part_stays_when_the_link_ends_and_comes_back(
        self, bench: GripperBench
    ) -> None:
        await bench.gripper.connect()
        await bench.gripper.close()
        await bench.gripper.disconnect()
        await bench.gripper.connect()
        await bench.gripper.confirm_part()
        bench.cut()
        await until_faulty(bench)
        await asyncio.sleep(1.2)  # longer than any bench's watchdog
        await bench.gripper.connect()
        await bench.gripper.confirm_part()
        assert bench.travels() == 1
        assert bench.shut()

    # --- goals

    async def test_state(self, bench: GripperBench) -> None:
        async with bench.gripper as gripper:
            before_s = now_s()
            state = await gripper.state()
            assert before_s <= state.time_s <= now_s()
            assert (state.opened, state.closed, state.part_present) == (True, False, True)
            bench.take_part()
            assert not (await gripper.state()).part_present

    async def test_closing_and_opening(self, bench: GripperBench) -> None:
        async with bench.gripper as gripper:
            for _ in range(2):
                state = await gripper.close()
                assert bench.shut()
                assert (state.opened, state.closed, state.part_present) == (False, True, True)
                state = await gripper.open()
                assert not bench.shut()
                assert (state.opened, state.closed) == (True, False)
            assert bench.travels() == 4

    async def test_goals_that_are_reached_move_nothing(self, bench: GripperBench) -> None:
        async with bench.gripper as gripper:
            await gripper.open()
            await gripper.open()
            assert bench.travels() == 0
            await gripper.close()
            await gripper.close()
            await gripper.confirm_part()
            assert bench.travels() == 1

    async def test_a_cancelled_call_leaves_a_sound_link(self, bench: GripperBench) -> None:
        async with bench.gripper as gripper:
            closing = asyncio.create_task(gripper.close())
            await asyncio.wait({closing}, timeout=0.05)
            closing.cancel()
            await asyncio.gather(closing, return_exceptions=True)
            state = await gripper.close()
            assert state.part_present

    # --- what goes wrong

    async def test_jaws_that_do_not_close(self, bench: GripperBench) -> None:
        async with bench.gripper as gripper:
            bench.jam()
            async with asyncio.timeout(5.0):
                with pytest.raises(GripperNotClosed):
                    await gripper.close()

    async def test_jaws_that_do_not_open(self, bench: GripperBench) -> None:
        async with bench.gripper as gripper:
            await gripper.close()
            bench.jam()
            async with asyncio.timeout(5.0):
                with pytest.raises(GripperNotOpened):
                    await gripper.open()

    async def test_closing_without_a_part(self, bench: GripperBench) -> None:
        bench.take_part()
        async with bench.gripper as gripper:
            async with asyncio.timeout(5.0):
                with pytest.raises(NoPartGripped):
                    await gripper.close()
            await gripper.open()

    async def test_a_part_that_is_lost(self, bench: GripperBench) -> None:
        async with bench.gripper as gripper:
            await gripper.close()
            await gripper.confirm_part()
            bench.take_part()
            with pytest.raises(PartLost):
                await gripper.confirm_part()
            assert bench.travels() == 1

    async def test_open_jaws_hold_nothing(self, bench: GripperBench) -> None:
        async with bench.gripper as gripper:
            with pytest.raises(PartLost):
                await gripper.confirm_part()

    async def test_sensors_that_contradict_each_other(self, bench: GripperBench) -> None:
        async with bench.gripper as gripper:
            bench.break_sensor()
            await gripper.open()
            with pytest.raises(GripperSensorsDisagree):
                await gripper.close()
            with pytest.raises(GripperSensorsDisagree):
                await gripper.state()

    async def test_silence_is_a_fault_in_bounded_time(self, bench: GripperBench) -> None:
        await bench.gripper.connect()
        bench.silence()
        async with asyncio.timeout(5.0):
            with pytest.raises(LinkError):
                await bench.gripper.close()
            with pytest.raises(LinkError):
                await bench.gripper.state()
        bench.restore()
        await bench.gripper.connect()
        assert (await bench.gripper.close()).part_present

    async def test_a_link_that_breaks_while_the_jaws_travel(self, bench: GripperBench) -> None:
        await bench.gripper.connect()
        closing = asyncio.create_task(bench.gripper.close())
        async with asyncio.timeout(5.0):
            while not bench.travels():  # noqa: ASYNC110  the device tells nobody
                await asyncio.sleep(0.005)
        bench.cut()
        with pytest.raises(LinkError):
            await closing
        await bench.gripper.connect()
        assert (await bench.gripper.close()).part_present
        assert bench.travels() == 1
