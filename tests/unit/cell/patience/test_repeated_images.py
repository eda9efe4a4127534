import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.cell.patience.patient_devices import PatientCamera, PatientHead
from cellctl.cell.patience.repeated_images import RepeatedImages
from cellctl.errors.camera import ImageRepeated
from cellctl.interfaces import Camera, CameraImage, PixelFormat, StereoCamera, StereoPair


def noisy(seed: int) -> NDArray[np.uint8]:
    return np.random.default_rng(seed).normal(100, 2, (8, 8)).astype(np.uint8)


class Grabber(Camera):
    """Hands out the images that it is given, each under a new number."""

    name = "eye"

    def __init__(self, *seeds: int) -> None:
        self._seeds = list(seeds)
        self.frame_id = 0

    async def connect(self) -> None: ...

    async def disconnect(self) -> None: ...

    async def serial_number(self) -> str:
        return "1"

    async def grab(self) -> CameraImage:
        self.frame_id += 1
        image = noisy(self._seeds.pop(0))
        return CameraImage(image, PixelFormat.MONO8, float(self.frame_id), self.frame_id)


class HeadGrabber(Grabber, StereoCamera):
    """The same for a head; its right camera always exposes."""

    async def grab(self) -> StereoPair:  # type: ignore[override]
        left = await super().grab()
        right = noisy(100 + left.frame_id)
        pixels = left.pixels.astype(np.uint8)
        return StereoPair(pixels, right, left.time_s, left.frame_id)


async def test_images_that_differ_by_their_noise_pass() -> None:
    camera = PatientCamera(Grabber(1, 2, 1))
    for _ in range(3):
        await camera.grab()


async def test_an_image_that_comes_again_under_a_new_number_is_refused() -> None:
    camera = PatientCamera(Grabber(1, 2, 2))
    await camera.grab()
    await camera.grab()
    with pytest.raises(ImageRepeated, match="eye: image"):
        await camera.grab()


async def test_one_camera_of_a_head_that_repeats_is_enough() -> None:
    head = PatientHead(HeadGrabber(1, 1))
    await head.grab()
    with pytest.raises(ImageRepeated, match="left image"):
        await head.grab()


@pytest.mark.parametrize("other", [False, True], ids=["all", "but for a dead or hot pixel"])
@pytest.mark.parametrize("grey", [0, 255])
def test_an_image_of_one_grey_is_left_to_the_checks_of_its_light(grey: int, other: bool) -> None:
    repeated = RepeatedImages("eye")
    for _ in range(2):
        image = np.full((4, 4), grey, dtype=np.uint8)
        if other:
            image[1, 2] = 255 - grey
        repeated.require_new({"image": image})
