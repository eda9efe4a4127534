"""Raw images as a store has them."""

import zstandard

from cellctl.interfaces.stereo_camera import Image


def coded(image: Image) -> bytes:
    """The bytes of the file of an image, shape (height, width)."""
    height, width = image.shape
    return zstandard.compress(b"P5 %d %d 255\n" % (width, height) + image.tobytes())
