"""The brushed finish of a plate: a periodic tile, fixed to the part by its seed."""

from functools import lru_cache
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from fakes.render.optics.lens import Array

Image = NDArray[np.float32]

TEXEL_M: Final = 0.15e-3
_SHAPE: Final = (1024, 2048)


@lru_cache(maxsize=4)
def brushed_tile(seed: int) -> Image:
    """Zero mean, unit standard deviation, brushed along x; wraps round at its borders."""
    rng = np.random.default_rng([seed, 11])
    noise = np.fft.rfft2(rng.standard_normal(_SHAPE))
    frequency_y: Array = np.fft.fftfreq(_SHAPE[0]).astype(np.float64)[:, None]
    frequency_x: Array = np.fft.rfftfreq(_SHAPE[1]).astype(np.float64)[None, :]
    strokes = _lowpass(frequency_x, 60.0) * _lowpass(frequency_y, 0.9)
    coarse = _lowpass(frequency_x, 220.0) * _lowpass(frequency_y, 6.0)
    grain = _lowpass(np.hypot(frequency_x, frequency_y), 0.8)
    mottle = _lowpass(np.hypot(frequency_x, frequency_y), 90.0)
    tile = np.zeros(_SHAPE)
    for response, weight in ((strokes, 1.0), (coarse, 0.6), (grain, 0.35), (mottle, 0.5)):
        part = np.fft.irfft2(noise * response, s=_SHAPE)
        tile += weight * part / part.std()
        # Another part of the same noise for each layer: drawn from the same frequencies, the layers
        # would add up to one.
        noise = np.roll(noise, 7, axis=1)
    result: Image = ((tile - tile.mean()) / tile.std()).astype(np.float32)
    # Shared by all pictures of a part through the cache.
    result.setflags(write=False)
    return result


def sample(tile: Image, x_m: NDArray[np.floating], y_m: NDArray[np.floating]) -> Image:
    """Values of a tile at surface coordinates, bilinear."""
    return np.asarray(
        cv2.remap(
            tile,
            (x_m * (1 / TEXEL_M)).astype(np.float32, copy=False),
            (y_m * (1 / TEXEL_M)).astype(np.float32, copy=False),
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_WRAP,
        ),
        dtype=np.float32,
    )


def _lowpass(frequency: Array, sigma_texel: float) -> Array:
    return np.asarray(np.exp(-2 * (np.pi * frequency * sigma_texel) ** 2))
