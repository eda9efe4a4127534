"""What every stereo head must do."""

import asyncio
from abc import ABC, abstractmethod

import numpy as np
import pytest

from cellctl.clock import now_s
from cellctl.errors.link import LinkError
from cellctl.interfaces.stereo_camera import StereoCamera


class CameraBench(ABC):
    """A head under test, not connected."""

    camera: StereoCamera

    @abstractmethod
    def exposures(self) -> int:
        """Pairs that the head has exposed."""

    @abstractmethod
    def silence(self) -> None:
        """The next request gets no answer."""

    @abstractmethod
    def cut(self) -> None:
        """The next request breaks the link."""


class StereoCameraContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    async def bench(self) -> CameraBench:
        """A fresh bench, torn down after the test."""

    async def test_connecting_is_idempotent_and_exposes_nothing(self, bench: CameraBench) -> None:
        await bench.camera.connect()
        await bench.camera.connect()
        assert bench.exposures() == 0

    async def test_disconnect_in_any_state(self, bench: CameraBench) -> None:
        await bench.camera.disconnect()
        await bench.camera.connect()
        await bench.camera.disconnect()
        await bench.camera.disconnect()
        with pytest.raises(LinkError):
            await bench.camera.grab()

    async def test_connect_again(self, bench: CameraBench) -> None:
        for _ in range(2):
            async with bench.camera as camera:
                await camera.grab()

    async def test_serial_number(self, bench: CameraBench) -> None:
        async with bench.camera as camera:
            assert await camera.serial_number()
            assert await camera.serial_number() == await camera.serial_number()

    async def test_a_pair_is_exposed_after_the_call(self, bench: CameraBench) -> None:
        async with bench.camera as camera:
            for number in (1, 2, 3):
                before_s = now_s()
                pair = await camera.grab()
                assert before_s <= pair.time_s <= now_s()
                assert bench.exposures() == number

    async def test_images(self, bench: CameraBench) -> None:
        async with bench.camera as camera:
            pair = await camera.grab()
        assert pair.left.dtype == pair.right.dtype == np.uint8
        assert pair.left.ndim == 2
        assert pair.left.shape == pair.right.shape
        assert not np.array_equal(pair.left, pair.right)

    async def test_frame_numbers_count_up_by_one(self, bench: CameraBench) -> None:
        async with bench.camera as camera:
            numbers = [(await camera.grab()).frame_id for _ in range(3)]
        assert numbers == [numbers[0], numbers[0] + 1, numbers[0] + 2]

    async def test_callers_do_not_get_each_others_pairs(self, bench: CameraBench) -> None:
        async with bench.camera as camera:
            pairs = await asyncio.gather(*(camera.grab() for _ in range(4)))
        assert len({pair.frame_id for pair in pairs}) == 4

    async def test_a_broken_link_is_a_fault_and_then_over(self, bench: CameraBench) -> None:
        async with bench.camera as camera:
            bench.cut()
            with pytest.raises(LinkError):
                await camera.grab()
            await camera.connect()
            await camera.grab()

    async def test_silence_is_a_fault_in_bounded_time(self, bench: CameraBench) -> None:
        async with bench.camera as camera:
            bench.silence()
            async with asyncio.timeout(2.0):
                with pytest.raises(LinkError):
                    await camera.grab()
            await camera.connect()
            first = await camera.grab()
            assert (await camera.grab()).frame_id == first.frame_id + 1

    async def test_cancelling_leaves_no_pair_behind(self, bench: CameraBench) -> None:
        async with bench.camera as camera:
            bench.silence()
            grab = asyncio.create_task(camera.grab())
            await asyncio.wait({grab}, timeout=0.05)
            grab.cancel()
            with pytest.raises(asyncio.CancelledError):
                await grab
            await camera.connect()
            before = bench.exposures()
            await camera.grab()
            assert bench.exposures() == before + 1
