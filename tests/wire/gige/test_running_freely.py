"""Cameras without a trigger: one, and two as a head."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from cellctl.clock import now_s
from cellctl.errors.camera import CamerasNotTogether
from drivers.camera.gige.config import GigeHeadConfig, Selection
from drivers.camera.gige.driver import GigeHead
from fakes.gentl.cameras import FakeCameras, expected_image
from tests.wire.gige.conftest import LEFT, RIGHT, camera

FRAME_S = 0.020
"""Time from frame to frame of a fake that runs freely; it exposes all of the time."""


def head(producer: Path, **settings: Any) -> GigeHead:
    asked: dict[str, Any] = {
        "left": Selection(serial_number=LEFT),
        "right": Selection(serial_number=RIGHT),
        "producers": (producer,),
        "trigger": "none",
        "image_timeout_s": 20.0,
        "max_difference_s": 20.0,
    } | settings
    return GigeHead("head", GigeHeadConfig(**asked))


async def test_an_image_is_exposed_wholly_after_its_request(
    producer: Path, fakes: FakeCameras
) -> None:
    async with camera(producer, trigger="none", image_timeout_s=5.0) as eye:
        for _ in range(10):
            asked_s = now_s()
            image = await eye.grab()
            assert image.exposure is not None
            assert image.exposure.device_time_ns is not None
            # The fake stamps the end of the exposure, with the clock of this PC.
            assert image.exposure.device_time_ns * 1e-9 - FRAME_S >= asked_s


async def test_a_head_of_two(producer: Path, fakes: FakeCameras) -> None:
    async with head(producer) as eyes:
        pairs = [await eyes.grab() for _ in range(3)]
    for number, fake in enumerate((LEFT, RIGHT)):
        seen = {n: expected_image(n, 64, 48, "Mono8", camera=number) for n in range(1, 1000)}
        images = [(pair.left, pair.right)[number] for pair in pairs]
        frames = [next(n for n, one in seen.items() if np.array_equal(one, i)) for i in images]
        # Image levels repeat after 256 frames, of which this test takes some tens.
        assert frames == sorted(set(frames)), fake


async def test_a_head_whose_second_camera_comes_late(producer: Path, fakes: FakeCameras) -> None:
    async with head(producer, max_difference_s=1.0) as eyes:
        fakes.inject(RIGHT, "slow_ms", 500)
        with pytest.raises(CamerasNotTogether):
            await eyes.grab()


async def test_clocks_that_agree_know_better_than_this_pc(
    producer: Path, fakes: FakeCameras
) -> None:
    """From the request to the third frame it takes 2 s and more; the frames lie closer."""
    for serial in (LEFT, RIGHT):
        fakes.inject(serial, "slow_ms", 1000)
    async with head(producer, clocks_agree=True, max_difference_s=1.9) as eyes:
        await eyes.grab()
    async with head(producer, max_difference_s=1.9) as eyes:
        with pytest.raises(CamerasNotTogether):
            await eyes.grab()


def test_for_how_long_nothing_moves_is_asked() -> None:
    left, right = Selection(serial_number=LEFT), Selection(serial_number=RIGHT)
    with pytest.raises(ValidationError, match="max_difference_s"):
        GigeHeadConfig(left=left, right=right, trigger="none")
    with pytest.raises(ValidationError, match="right_trigger"):
        GigeHeadConfig(
            left=left, right=right, trigger="none", right_trigger="Line1", max_difference_s=1.0
        )
