"""Memory in which images go to the daemon, in the process of the maker's library."""

import mmap
import os
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

MOST_FREE = 4
"""Blocks that are kept for later images; the others go back to the system."""


@dataclass(frozen=True, slots=True)
class _Block:
    """Memory that stays mapped: the first touch of each page costs more than its copy."""

    descriptor: int
    memory: mmap.mmap

    @classmethod
    def of(cls, size: int) -> "_Block":
        descriptor = os.memfd_create("gige-image", os.MFD_CLOEXEC)
        try:
            os.ftruncate(descriptor, size)
            return cls(descriptor, mmap.mmap(descriptor, size))
        except BaseException:
            # No memory left, or an image without a pixel, which comes again and again.
            os.close(descriptor)
            raise

    def close(self) -> None:
        self.memory.close()
        os.close(self.descriptor)


class ImageMemory:
    """Blocks of anonymous memory, each used again once the daemon has let go of its image.

    Memory that is new for each image would be cleared by the system first, page by page, which
    takes five times as long as the copy. A block is called by its descriptor in this process.
    """

    def __init__(self) -> None:
        self._free: list[_Block] = []
        self._lent: dict[int, _Block] = {}

    def filled(self, data: NDArray[np.uint8]) -> int:
        """Lend a block with a copy of ``data``: the only one on the way to the daemon."""
        block = self._free_block(len(data))
        np.copyto(np.frombuffer(block.memory, dtype=np.uint8), data)
        self._lent[block.descriptor] = block
        return block.descriptor

    def take_back(self, blocks: Iterable[int]) -> None:
        """Nobody reads these any more; raises ``KeyError`` for one that is not lent."""
        for block in blocks:
            returned = self._lent.pop(block)
            if len(self._free) < MOST_FREE:
                self._free.append(returned)
            else:
                returned.close()

    def _free_block(self, size: int) -> _Block:
        while self._free:
            block = self._free.pop()
            if len(block.memory) == size:
                return block
            block.close()  # images have another size now
        return _Block.of(size)
