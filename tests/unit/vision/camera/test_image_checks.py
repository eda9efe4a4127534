"""Contrast is judged by places of an image: small holes in an even plate are enough of it."""

import numpy as np
import pytest

from cellctl.errors.vision import ImageBlurred
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.image_checks import check_image

SIZE = (1600, 1200)


def plate(level: float, noise_grey: float) -> Image:
    rng = np.random.default_rng(3)
    image = level + rng.normal(0.0, noise_grey, SIZE[::-1])
    return np.asarray(np.clip(np.rint(image), 0, 255), dtype=np.uint8)


def test_three_small_holes_are_contrast_enough() -> None:
    image = plate(215.0, 0.8)
    y, x = np.ogrid[: SIZE[1], : SIZE[0]]
    for column, row in ((400, 300), (1100, 350), (700, 900)):
        image[np.hypot(x - column, y - row) < 15.0] = 90
    check_image(image, SIZE, "left")


@pytest.mark.parametrize("noise_grey", [0.8, 6.0])
def test_noise_and_hot_pixels_are_no_contrast(noise_grey: float) -> None:
    image = plate(120.0, noise_grey)
    image[::97, ::113] = 255
    with pytest.raises(ImageBlurred, match="left: grey values differ by only"):
        check_image(image, SIZE, "left")
