"""What every single camera must do, grey or colour."""

import asyncio
from abc import ABC, abstractmethod

import numpy as np
import pytest

from cellctl.clock import now_s
from cellctl.errors.link import LinkError
from cellctl.interfaces.camera import Camera, CameraImage, PixelFormat

SHAPES = {
    PixelFormat.MONO8: (np.uint8, 2),
    PixelFormat.MONO16: (np.uint16, 2),
    PixelFormat.RGB8: (np.uint8, 3),
    PixelFormat.RGB16: (np.uint16, 3),
}
"""Type of a sample and number of dimensions."""


class SingleCameraBench(ABC):
    """A camera under test, not connected."""

    camera: Camera

    @abstractmethod
    def truth(self) -> CameraImage:
        """What the newest exposure showed; its time is not looked at."""

    @abstractmethod
    def exposures(self) -> int:
        """Images that the camera has exposed."""

    @abstractmethod
    def silence(self) -> None:
        """The next request gets no answer."""

    @abstractmethod
    def cut(self) -> None:
        """The next request breaks the link."""


class CameraContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    async def bench(self) -> SingleCameraBench:
        """A fresh bench, torn down after the test. Parametrised with what the device can send."""

    async def test_connecting_is_idempotent_and_exposes_nothing(
        self, bench: SingleCameraBench
    ) -> None:
        await bench.camera.connect()
        await bench.camera.connect()
        assert bench.exposures() == 0

    async def test_disconnect_in_any_state(self, bench: SingleCameraBench) -> None:
        await bench.camera.disconnect()
        await bench.camera.connect()
        await bench.camera.disconnect()
        await bench.camera.disconnect()
        with pytest.raises(LinkError):
            await bench.camera.grab()

    async def test_connect_again(self, bench: SingleCameraBench) -> None:
        for _ in range(2):
            async with bench.camera as camera:
                await camera.grab()

    async def test_serial_number(self, bench: SingleCameraBench) -> None:
        async with bench.camera as camera:
            assert await camera.serial_number()
            assert await camera.serial_number() == await camera.serial_number()

    async def test_an_image_is_exposed_after_the_call(self, bench: SingleCameraBench) -> None:
        async with bench.camera as camera:
            for number in (1, 2, 3):
                before_s = now_s()
                image = await camera.grab()
                assert before_s <= image.time_s <= now_s()
                assert bench.exposures() == number

    async def test_pixels_are_those_that_were_exposed(self, bench: SingleCameraBench) -> None:
        async with bench.camera as camera:
            images = [await camera.grab() for _ in range(2)]
        sample, dimensions = SHAPES[images[0].pixel_format]
        for image in images:
            assert image.pixels.dtype == sample
            assert image.pixels.ndim == dimensions
            assert image.pixels.shape[2:] in {(), (3,)}
        truth = bench.truth()
        assert images[-1].pixel_format is truth.pixel_format
        assert np.array_equal(images[-1].pixels, truth.pixels)
        assert not np.array_equal(images[0].pixels, images[1].pixels)

    async def test_frame_numbers_count_up_by_one(self, bench: SingleCameraBench) -> None:
        async with bench.camera as camera:
            numbers = [(await camera.grab()).frame_id for _ in range(3)]
        assert numbers == [numbers[0], numbers[0] + 1, numbers[0] + 2]

    async def test_callers_do_not_get_each_others_images(self, bench: SingleCameraBench) -> None:
        async with bench.camera as camera:
            images = await asyncio.gather(*(camera.grab() for _ in range(4)))
        assert len({image.frame_id for image in images}) == 4

    async def test_a_broken_link_is_a_fault_and_then_over(self, bench: SingleCameraBench) -> None:
        async with bench.camera as camera:
            bench.cut()
            with pytest.raises(LinkError):
                await camera.grab()
            await camera.connect()
            await camera.grab()

    async def test_silence_is_a_fault_in_bounded_time(self, bench: SingleCameraBench) -> None:
        async with bench.camera as camera:
            bench.silence()
            async with asyncio.timeout(2.0):
                with pytest.raises(LinkError):
                    await camera.grab()
            await camera.connect()
            first = await camera.grab()
            assert (await camera.grab()).frame_id == first.frame_id + 1

    async def test_cancelling_leaves_no_image_behind(self, bench: SingleCameraBench) -> None:
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
