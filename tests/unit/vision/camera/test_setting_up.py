"""Figures for setting a camera up, on drawn images of which the truth is known."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.vision.camera.setting_up import image_figures, overlap_share

Grey = NDArray[np.uint8]


def squares(blur_px: float, contrast: float, noise: float) -> Grey:
    """Dark squares, drawn with four subpixels along each axis."""
    y, x = np.mgrid[0:1600, 0:2000] // 4
    fine = np.where((x // 50 + y // 50) % 2 == 0, 0.0, contrast).astype(np.float32)
    sharp = cv2.resize(fine, (500, 400), interpolation=cv2.INTER_AREA)
    image = 30.0 + cv2.GaussianBlur(sharp, (0, 0), blur_px)
    image = image + np.random.default_rng(1).normal(0.0, noise, image.shape)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("blur_px", [0.8, 1.5, 3.0])
@pytest.mark.parametrize("contrast", [60.0, 180.0])
def test_blur_is_that_of_the_edges_in_any_light(blur_px: float, contrast: float) -> None:
    seen_px = image_figures(squares(blur_px, contrast, noise=1.0)).blur_px
    assert seen_px == pytest.approx(blur_px, rel=0.25)


def test_light_is_counted() -> None:
    image = np.full((100, 100), 100, dtype=np.uint8)
    image[:10] = 255
    image[10:15] = 0
    figures = image_figures(image)
    assert figures.saturated_share == pytest.approx(0.10)
    assert figures.black_share == pytest.approx(0.05)
    assert (figures.median_grey, figures.bright_grey) == (100, 255)


def test_an_image_without_contrast_has_no_blur() -> None:
    assert image_figures(np.full((50, 50), 80, dtype=np.uint8)).blur_px is None


def texture(seed: int) -> Grey:
    noise = np.random.default_rng(seed).uniform(0, 255, (600, 900)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 4.0)
    stretched = 255.0 * (smooth - smooth.min()) / np.ptp(smooth)
    return np.asarray(np.rint(stretched), dtype=np.uint8)


@pytest.mark.parametrize("shift_px", [0, 100, 250])
def test_overlap_of_two_views(shift_px: int) -> None:
    scene = texture(3)
    left, right = scene[:480, :640], scene[:480, shift_px : shift_px + 640]
    assert overlap_share(left, right) == pytest.approx(1 - shift_px / 640, abs=0.03)


@pytest.mark.parametrize(
    "right", [texture(4)[:480, :640], np.zeros((480, 640), dtype=np.uint8)], ids=["other", "black"]
)
def test_views_that_share_nothing(right: Grey) -> None:
    assert overlap_share(texture(3)[:480, :640], right) is None
