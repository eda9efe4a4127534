"""What a single exposure does to the clean picture of a scene: sway, smear, brightness."""

import cv2
import numpy as np
from numpy.typing import NDArray

from fakes.render.optics.canvas import Image
from fakes.world.scene import Exposure


def taken(picture: Image, exposure: Exposure, focal_px: float) -> Image:
    """The picture as this exposure takes it.

    Three cells in each direction are enough for shifts of a tenth of a pixel: they have the mean
    and the variance of the motion, at the cost of one pass over the picture.
    """
    if exposure == Exposure():
        return picture
    across, down = (
        _kernel(sway * focal_px, smear * focal_px)
        for sway, smear in zip(exposure.sway_rad, exposure.smear_rad, strict=True)
    )
    moved = cv2.sepFilter2D(
        picture, cv2.CV_32F, exposure.gain * across, down, borderType=cv2.BORDER_REPLICATE
    )
    return np.asarray(moved, dtype=np.float32)


def _kernel(shift_px: float, sigma_px: float) -> NDArray[np.float64]:
    """Three weights with mean ``shift_px`` and standard deviation ``sigma_px``."""
    square = sigma_px**2 + shift_px**2
    return np.array([square + shift_px, 2 - 2 * square, square - shift_px]) / 2
