"""What every large-field head must do."""

import asyncio
from abc import ABC, abstractmethod

import pytest

from cellctl.errors.link import LinkError
from cellctl.geometry.pose import Array
from cellctl.interfaces.target_tracker import TargetTracker


class TrackerBench(ABC):
    """A head under test, not connected, that sees the targets of ``truth`` (m)."""

    tracker: TargetTracker
    truth: dict[str, Array]

    @abstractmethod
    def hide(self, name: str) -> None:
        """Put something before a target."""

    @abstractmethod
    def silence(self) -> None:
        """The next request gets no answer."""

    @abstractmethod
    def garble(self) -> None:
        """The next answer makes no sense."""


class TargetTrackerContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    async def bench(self) -> TrackerBench:
        """A fresh bench, torn down after the test."""

    async def test_disconnect_in_any_state(self, bench: TrackerBench) -> None:
        await bench.tracker.disconnect()
        await bench.tracker.connect()
        await bench.tracker.connect()
        await bench.tracker.disconnect()
        await bench.tracker.disconnect()
        with pytest.raises(LinkError):
            await bench.tracker.measure()

    async def test_connect_again(self, bench: TrackerBench) -> None:
        for _ in range(2):
            async with bench.tracker as tracker:
                await tracker.measure()

    async def test_serial_number(self, bench: TrackerBench) -> None:
        async with bench.tracker as tracker:
            assert await tracker.serial_number()
            assert await tracker.serial_number() == await tracker.serial_number()

    async def test_targets_are_where_they_are(self, bench: TrackerBench) -> None:
        async with bench.tracker as tracker:
            seen = {target.name: target for target in await tracker.measure(10)}
        assert seen.keys() == bench.truth.keys()
        for name, target in seen.items():
            assert target.position_m.shape == (3,)
            assert 0.0 < target.sigma_m < 1e-3
            assert abs(target.position_m - bench.truth[name]).max() < 6 * target.sigma_m

    async def test_hidden_targets_are_left_out(self, bench: TrackerBench) -> None:
        name = next(iter(bench.truth))
        bench.hide(name)
        async with bench.tracker as tracker:
            seen = {target.name for target in await tracker.measure()}
        assert seen == bench.truth.keys() - {name}

    async def test_callers_wait_for_each_other(self, bench: TrackerBench) -> None:
        async with bench.tracker as tracker:
            measured = await asyncio.gather(*(tracker.measure() for _ in range(4)))
        assert [len(targets) for targets in measured] == [len(bench.truth)] * 4

    async def test_silence_is_a_fault_in_bounded_time(self, bench: TrackerBench) -> None:
        async with bench.tracker as tracker:
            bench.silence()
            async with asyncio.timeout(2.0):
                with pytest.raises(LinkError):
                    await tracker.measure()
            await tracker.connect()
            assert await tracker.measure()

    async def test_nonsense_is_a_fault_and_then_over(self, bench: TrackerBench) -> None:
        async with bench.tracker as tracker:
            bench.garble()
            with pytest.raises(LinkError):
                await tracker.measure()
            await tracker.connect()
            assert await tracker.measure()
