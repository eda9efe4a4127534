"""Images as the cameras gave them, coded without loss by a thread beside the run."""

import re
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import zstandard
from numpy.typing import NDArray

from cellctl.errors.records.store import ArtefactDamaged
from cellctl.records.files.artefacts import ArtefactFolder

MEDIA_TYPE = "application/zstd"
"""PGM inside: `zstd -d` gives a picture that any viewer opens."""
_LEVEL = 1
"""Noise cannot be compressed: more effort costs seconds and saves a few per cent. PNG takes ten
times as long."""
_HEADER = re.compile(rb"P5 (\d+) (\d+) 255\n")

GreyImage = NDArray[np.uint8]


def coding_thread() -> ThreadPoolExecutor:
    """One thread for ``encode_and_put``, at the daemon's own priority.

    A nicer thread would be worse for whatever moves: while it waits for a processor it may hold the
    interpreter's lock, and then the event loop with all heartbeats waits for it. The work itself is
    20 ms an image, outside that lock.
    """
    return ThreadPoolExecutor(1, "raw-images")


def encode_and_put(image: GreyImage, files: ArtefactFolder) -> bytes:
    """An image, shape (height, width), coded and on the disk; raises ``RecordNotWritten``.

    Written here, so that the thread of the run store, for which runs wait, has only the row left.
    """
    height, width = image.shape
    plain = b"P5 %d %d 255\n" % (width, height) + image.tobytes()
    data = zstandard.compress(plain, _LEVEL)
    files.put(data)
    return data


def decode(data: bytes) -> GreyImage:
    """The image, shape (height, width); raises ``ArtefactDamaged``."""
    try:
        plain = zstandard.decompress(data)
    except zstandard.ZstdError as error:
        raise ArtefactDamaged(f"not a raw image: {error}") from error
    header = _HEADER.match(plain)
    if header is None:
        raise ArtefactDamaged("not a raw image")
    width, height = int(header[1]), int(header[2])
    pixels = np.frombuffer(plain, np.uint8, offset=header.end())
    # An array over bytes cannot be written to, and it would keep the whole file in memory.
    return pixels.reshape(height, width).copy()
