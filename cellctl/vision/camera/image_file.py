"""Image files as they were written, for commands that work from files."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.errors.vision import ImageFileInvalid

_PNG, _PNG_END = b"\x89PNG", b"IEND"
_END_BYTES = 64
"""The last chunk has 12 bytes; some programs let a few more follow."""


def read_unchanged(path: Path) -> NDArray[Any]:
    """The values of a file, in its own type and channels; raises ``ImageFileInvalid``."""
    try:
        # Read here instead of by OpenCV, which returns nothing at all for a missing file, without a
        # reason.
        content = path.read_bytes()
    except OSError as error:
        raise ImageFileInvalid(f"{path}: {error.strerror or error}") from error
    # Told here, because libpng would print a line of its own to the terminal.
    if content.startswith(_PNG) and _PNG_END not in content[-_END_BYTES:]:
        raise ImageFileInvalid(f"{path}: is cut off, copy it again: the end of the PNG is missing")
    data = np.frombuffer(content, dtype=np.uint8)
    image = cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if data.size else None
    if image is None:
        raise ImageFileInvalid(f"{path}: {'not an image, or cut off' if content else 'is empty'}")
    return np.asarray(image)
