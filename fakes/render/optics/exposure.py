"""What a single exposure does to the clean picture of a scene: sway, smear, brightness."""

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from fakes.render.optics.canvas import Image
from fakes.world.scene import Exposure

_FROM_MOMENTS: Final[NDArray[np.float64]] = np.linalg.inv(
    np.vander(np.arange(-2.0, 3.0), increasing=True).T
)


def taken(picture: Image, exposure: Exposure, focal_px: float) -> Image:
    """The picture as this exposure takes it.

    Five cells in each direction have the first four moments of the motion. Three would have its
    mean and variance, but are skewed: a sharp edge, whose place is not that of its centre of
    light, then follows a sway by 85 % only.
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
    """Five weights with the moments of a normal spread about ``shift_px``."""
    # A filter gathers: what moves to the right comes from the left.
    mean, variance = -shift_px, sigma_px**2
    moments = np.array(
        [
            1.0,
            mean,
            mean**2 + variance,
            mean**3 + 3.0 * mean * variance,
            mean**4 + 6.0 * mean**2 * variance + 3.0 * variance**2,
        ]
    )
    return np.asarray(_FROM_MOMENTS @ moments)
