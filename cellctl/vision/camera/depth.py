"""Grey values of deep cameras in the eight bits that everything here measures."""

import numpy as np
from numpy.typing import NDArray

from cellctl.interfaces.stereo_camera import Image


def eight_bits(pixels: NDArray[np.uint16], bits: int) -> Image:
    """The upper eight of the ``bits`` low bits of each sample; raises ``ValueError`` below 8."""
    if bits < 8:
        raise ValueError(f"a sample of {bits} bits has no eight")
    return np.asarray(pixels >> (bits - 8), dtype=np.uint8)
