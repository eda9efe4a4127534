"""Images as the cameras gave them: coded without loss by a thread of the lowest priority."""

import os
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from cellctl.errors.records import ArtefactDamaged
from cellctl.records.artefacts import ArtefactFolder

MEDIA_TYPE = "application/vnd.cellctl.raw-image+png"
"""PNG, and no picture of the report: those are the annotated ones."""
_LOWEST_PRIORITY = 19
_PNG_STRATEGY_HUFFMAN_ONLY = 2
"""Noise has no repetitions to look for: without the search the files are smaller, and sooner."""

GreyImage = NDArray[np.uint8]


def lowest_priority_thread() -> ThreadPoolExecutor:
    """One thread that computes when nobody else wants to."""
    return ThreadPoolExecutor(1, "raw-images", initializer=_at_lowest_priority)


def encode_and_put(image: GreyImage, files: ArtefactFolder) -> bytes:
    """An image, shape (height, width), as PNG that is on the disk; raises ``RecordNotWritten``.

    Written here, so that the thread of the run store, for which runs wait, has only the row left.
    """
    import cv2

    options = [cv2.IMWRITE_PNG_COMPRESSION, 1, cv2.IMWRITE_PNG_STRATEGY, _PNG_STRATEGY_HUFFMAN_ONLY]
    _, encoded = cv2.imencode(".png", image, options)
    data = bytes(encoded)
    files.put(data)
    return data


def decode(data: bytes) -> GreyImage:
    """The image, shape (height, width); raises ``ArtefactDamaged``."""
    import cv2

    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    if image is None or image.dtype != np.uint8 or image.ndim != 2:
        raise ArtefactDamaged("not a raw image")
    return np.asarray(image, np.uint8)


def _at_lowest_priority() -> None:
    # On Linux every thread has a niceness of its own.
    os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _LOWEST_PRIORITY)
