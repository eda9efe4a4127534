"""Blur of the lens, noise of the sensor, eight bits."""

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from fakes.render.optics.lens import Array
from fakes.render.options import RenderOptions

Grey = NDArray[np.uint8]
Image = NDArray[np.float32]

REACH: Final = 4.5
"""Half width of the sampled kernel in standard deviations."""


def blurred(image: Image, sigma_px: float) -> Image:
    """Convolve a picture with a Gaussian point spread; the pixel's own box is already in it.

    Pixels are too coarse for the convolution of a sharp edge: its profile would depend on where
    in a pixel the edge lies. Whatever is measured comes already blurred, from finer cells.
    """
    if sigma_px <= 0:
        return image
    return np.asarray(_convolved(image, sigma_px, cv2.CV_32F), dtype=np.float32)


def blurred_cells(cells: Array, sigma_cells: float) -> Array:
    """``blurred`` for an array of cells, in double precision."""
    if sigma_cells <= 0:
        return cells
    return np.asarray(_convolved(cells, sigma_cells, cv2.CV_64F), dtype=np.float64)


def _convolved(image: Image | Array, sigma: float, depth: int) -> cv2.typing.MatLike:
    size = 2 * int(np.ceil(REACH * sigma)) + 1
    kernel = cv2.getGaussianKernel(size, sigma, depth)
    return cv2.sepFilter2D(image, depth, kernel, kernel, borderType=cv2.BORDER_REPLICATE)


def noise_sigma(clean: Image, options: RenderOptions) -> Image:
    """Standard deviation of every pixel: read noise and shot noise."""
    variance = np.float32(options.noise_grey**2)
    shot = np.float32(options.shot_share) * variance / np.float32(options.plate_grey)
    read = np.float32(1 - options.shot_share) * variance
    return np.asarray(np.sqrt(read + shot * np.maximum(clean, 0)), dtype=np.float32)


def exposed(clean: Image, options: RenderOptions, rng: np.random.Generator) -> Grey:
    """One exposure of a clean image: independent normal noise, rounded and clipped to 8 bits.

    With the thousands of electrons behind every grey level the Poisson law is a normal one.
    """
    if options.noise_grey <= 0:
        return np.asarray(cv2.add(clean, np.zeros_like(clean), dtype=cv2.CV_8U), dtype=np.uint8)
    noise = rng.standard_normal(clean.shape, dtype=np.float32)
    # Shot noise grows with the light, so the bright side of an edge is noisier than the dark one.
    noise *= noise_sigma(clean, options)
    # OpenCV adds, rounds and clips in one pass over five million pixels.
    return np.asarray(cv2.add(clean, noise, dtype=cv2.CV_8U), dtype=np.uint8)
