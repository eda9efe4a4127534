"""Heads that a wire triggers, the time between both exposures, and means of bursts."""

import asyncio
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from cellctl.errors.camera import CameraFeatureRefused, CamerasNotTogether
from cellctl.errors.link import ReplyTimeout
from drivers.camera.gige.config import GigeHeadConfig, Selection
from drivers.camera.gige.driver import GigeHead
from fakes.gentl.cameras import FakeCameras, expected_image
from tests.rigs.waiting import until
from tests.wire.gige.conftest import LEFT, RIGHT, camera


def head(producer: Path, **settings: Any) -> GigeHead:
    asked: dict[str, Any] = {
        "left": Selection(serial_number=LEFT),
        "right": Selection(serial_number=RIGHT),
        "producers": (producer,),
        "exposure_s": 0.001,
        "image_timeout_s": 10.0,
        "max_difference_s": 1.0,
        "clocks_agree": True,
    } | settings
    return GigeHead("head", GigeHeadConfig(**asked))


async def test_the_right_camera_is_wired_to_the_left(producer: Path, fakes: FakeCameras) -> None:
    fakes.wire(output=LEFT, to=RIGHT)
    async with head(producer, right_trigger="Line1") as eyes:
        pairs = [await eyes.grab() for _ in range(3)]
    for number, pair in enumerate(pairs, start=1):
        assert np.array_equal(pair.left, expected_image(number, 64, 48, "Mono8"))
        assert np.array_equal(pair.right, expected_image(number, 64, 48, "Mono8", camera=1))
    assert fakes.exposures(RIGHT) == 3


async def test_a_wire_that_is_not_there(producer: Path, fakes: FakeCameras) -> None:
    async with head(producer, right_trigger="Line1", image_timeout_s=2.0) as eyes:
        with pytest.raises(ReplyTimeout, match=RIGHT):
            await eyes.grab()


async def test_both_cameras_wait_for_the_pulse_of_another_device(
    producer: Path, fakes: FakeCameras
) -> None:
    async with head(producer, trigger="Line1", image_timeout_s=5.0) as eyes:
        # Nobody waits for this pulse, so its images are given to nobody.
        fakes.pulse()
        await until(lambda: fakes.exposures(LEFT) == fakes.exposures(RIGHT) == 1, within_s=60.0)
        grab = asyncio.create_task(eyes.grab())
        before = fakes.exposures(LEFT)
        while not grab.done():
            await asyncio.wait({grab}, timeout=0.1)
            fakes.pulse()
        pair = await grab
    assert before < fakes.exposures(LEFT)
    last = [
        expected_image(n, 64, 48, "Mono8") for n in range(before + 1, fakes.exposures(LEFT) + 1)
    ]
    assert any(np.array_equal(pair.left, image) for image in last)


async def test_clocks_that_agree_are_compared_from_the_first_pair_on(
    producer: Path, fakes: FakeCameras
) -> None:
    fakes.wire(output=LEFT, to=RIGHT)
    fakes.inject(RIGHT, "slow_ms", 2500)
    async with head(producer, right_trigger="Line1") as eyes:
        with pytest.raises(CamerasNotTogether, match=r"allowed 1000\.0 ms"):
            await eyes.grab()
        fakes.inject(RIGHT, "slow_ms", 0)
        await eyes.grab()


async def test_clocks_of_their_own_are_compared_by_their_change(
    producer: Path, fakes: FakeCameras
) -> None:
    fakes.wire(output=LEFT, to=RIGHT)
    async with head(producer, right_trigger="Line1", clocks_agree=False) as eyes:
        await eyes.grab()
        fakes.inject(RIGHT, "slow_ms", 2500)
        with pytest.raises(CamerasNotTogether):
            await eyes.grab()


async def test_features_of_one_camera(producer: Path, fakes: FakeCameras) -> None:
    async with head(producer, left_features={"Gain": 6.0}) as eyes:
        pair = await eyes.grab()
    assert [one.gain_db for one in pair.exposures] == [6.0, 0.0]


async def test_a_line_that_the_camera_does_not_have(producer: Path, fakes: FakeCameras) -> None:
    with pytest.raises(CameraFeatureRefused, match="Software, Line1"):
        await head(producer, trigger="Line4").connect()


@pytest.mark.parametrize("trigger", ["line1", "Line", "hardware", "Line1; DROP"])
def test_a_trigger_of_no_known_form(producer: Path, trigger: str) -> None:
    with pytest.raises(ValidationError):
        head(producer, trigger=trigger)


async def test_an_image_is_the_mean_of_its_burst(producer: Path, fakes: FakeCameras) -> None:
    async with camera(producer, burst=3, pixel_format="Mono12") as eye:
        images = [await eye.grab() for _ in range(2)]
    assert fakes.exposures(LEFT) == 6
    frames = [expected_image(n, 64, 48, "Mono12").astype(float) for n in (4, 5, 6)]
    assert np.abs(images[1].pixels - np.mean(frames, axis=0)).max() <= 0.5
    assert images[1].frame_id == images[0].frame_id + 1
    assert images[1].exposure is not None
    assert images[1].exposure.averaged == 3


async def test_a_head_takes_means_too(producer: Path, fakes: FakeCameras) -> None:
    async with head(producer, burst=2) as eyes:
        pair = await eyes.grab()
    for number, image in enumerate((pair.left, pair.right)):
        frames = [expected_image(n, 64, 48, "Mono8", camera=number).astype(float) for n in (1, 2)]
        assert image.dtype == np.uint8
        assert np.abs(image - np.mean(frames, axis=0)).max() <= 0.5


async def test_an_exposure_is_not_changed_within_the_burst_of_a_camera(
    producer: Path, fakes: FakeCameras
) -> None:
    async with camera(producer, burst=3) as eye:
        grab = asyncio.create_task(eye.grab())
        await until(lambda: fakes.begun(LEFT) >= 1, within_s=60.0)
        change = asyncio.create_task(eye.set_exposure(0.002))
        image, changed_s = await asyncio.gather(grab, change)
        after = await eye.grab()
    assert image.exposure is not None
    assert after.exposure is not None
    assert image.exposure.exposure_s == pytest.approx(0.001)
    assert after.exposure.exposure_s == pytest.approx(changed_s) == pytest.approx(0.002)


async def test_an_exposure_is_not_changed_within_the_burst_of_a_head(
    producer: Path, fakes: FakeCameras
) -> None:
    async with head(producer, burst=3) as eyes:
        grab = asyncio.create_task(eyes.grab())
        await until(lambda: fakes.begun(LEFT) >= 1, within_s=60.0)
        change = asyncio.create_task(eyes.set_exposure(0.002))
        pair, _ = await asyncio.gather(grab, change)
        after = await eyes.grab()
    assert [one.exposure_s for one in pair.exposures] == pytest.approx([0.001, 0.001])
    assert [one.exposure_s for one in after.exposures] == pytest.approx([0.002, 0.002])
