"""What every device that exposes on request must do: single cameras and stereo heads."""

import asyncio
from abc import ABC, abstractmethod

import pytest

from cellctl.clock import now_s
from cellctl.errors.link import LinkError
from cellctl.interfaces.camera import Camera
from cellctl.interfaces.stereo_camera import StereoCamera


class ExposureBench(ABC):
    """A device under test, not connected."""

    camera: Camera | StereoCamera

    @abstractmethod
    def exposures(self) -> int:
        """Images, or pairs of them, that the device has exposed."""

    @abstractmethod
    def silence(self) -> None:
        """The next request gets no answer."""

    @abstractmethod
    def cut(self) -> None:
        """The next request breaks the link."""


class ExposureContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    async def bench(self) -> ExposureBench:
        """A fresh bench, torn down after the test. Parametrised with what the device can send."""

    async def test_connecting_is_idempotent_and_exposes_nothing(self, bench: ExposureBench) -> None:
        await bench.camera.connect()
        await bench.camera.connect()
        assert bench.exposures() == 0

    async def test_disconnect_in_any_state(self, bench: ExposureBench) -> None:
        await bench.camera.disconnect()
        await bench.camera.connect()
        await bench.camera.disconnect()
        await bench.camera.disconnect()
        with pytest.raises(LinkError):
            await bench.camera.grab()

    async def test_connect_again(self, bench: ExposureBench) -> None:
        for _ in range(2):
            async with bench.camera as camera:
                await camera.grab()

    async def test_serial_number(self, bench: ExposureBench) -> None:
        async with bench.camera as camera:
            assert await camera.serial_number()
            assert await camera.serial_number() == await camera.serial_number()

    async def test_what_comes_is_exposed_after_the_call(self, bench: ExposureBench) -> None:
        async with bench.camera as camera:
            for number in (1, 2, 3):
                before_s = now_s()
                exposure = await camera.grab()
                assert before_s <= exposure.time_s <= now_s()
                assert bench.exposures() == number

    async def test_frame_numbers_count_up_by_one(self, bench: ExposureBench) -> None:
        async with bench.camera as camera:
            numbers = [(await camera.grab()).frame_id for _ in range(3)]
        assert numbers == [numbers[0], numbers[0] + 1, numbers[0] + 2]

    async def test_callers_do_not_get_each_others_exposures(self, bench: ExposureBench) -> None:
        async with bench.camera as camera:

            async def frame_id() -> int:
                return (await camera.grab()).frame_id

            frame_ids = await asyncio.gather(*(frame_id() for _ in range(4)))
        assert len(set(frame_ids)) == 4

    async def test_a_broken_link_is_a_fault_and_then_over(self, bench: ExposureBench) -> None:
        async with bench.camera as camera:
            bench.cut()
            with pytest.raises(LinkError):
                await camera.grab()
            await camera.connect()
            await camera.grab()

    async def test_silence_is_a_fault_in_bounded_time(self, bench: ExposureBench) -> None:
        async with bench.camera as camera:
            bench.silence()
            async with asyncio.timeout(2.0):
                with pytest.raises(LinkError):
                    await camera.grab()
            await camera.connect()
            first = await camera.grab()
            assert (await camera.grab()).frame_id == first.frame_id + 1

    async def test_cancelling_leaves_nothing_behind(self, bench: ExposureBench) -> None:
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
