"""Memory in which images go to the daemon, in the process of the maker's library."""

import os
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

MOST_FREE = 4
"""Blocks that are kept for later images; the others go back to the system."""


class ImageMemory:
    """Blocks of anonymous memory, each used again once the daemon has let go of its image.

    Memory that is new for each image would be cleared by the system first, page by page, which
    takes five times as long as the copy. A block is called by its descriptor in this process.
    """

    def __init__(self) -> None:
        self._free: list[int] = []
        self._lent: set[int] = set()

    def filled(self, data: NDArray[np.uint8]) -> int:
        """Lend a block with a copy of ``data``: the only one on the way to the daemon."""
        block = self._free.pop() if self._free else os.memfd_create("gige-image", os.MFD_CLOEXEC)
        self._lent.add(block)
        left, at = data.data, 0
        while left:
            written = os.pwrite(block, left, at)
            left, at = left[written:], at + written
        return block

    def take_back(self, blocks: Iterable[int]) -> None:
        """Nobody reads these any more; raises ``KeyError`` for one that is not lent."""
        for block in blocks:
            self._lent.remove(block)
            if len(self._free) < MOST_FREE:
                self._free.append(block)
            else:
                os.close(block)
