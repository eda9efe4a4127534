"""The mean of the images of a burst."""

from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T", np.uint8, np.uint16)


class RunningMean(Generic[T]):
    """Adds images of one shape up as they come; a single one is handed on as it is, uncopied."""

    def __init__(self) -> None:
        self._first: NDArray[T] | None = None
        self._sum: NDArray[np.uint32] | None = None
        self._count = 0

    def add(self, pixels: NDArray[T]) -> None:
        """Take one image in; raises ``ValueError`` for another shape."""
        self._count += 1
        if self._first is None:
            self._first = pixels
            return
        if self._sum is None:
            self._sum = self._first.astype(np.uint32)
        self._sum += pixels

    def pixels(self) -> NDArray[T]:
        """The mean, rounded, of the type of the images; raises ``ValueError`` without any."""
        if self._first is None:
            raise ValueError("there is no image to take the mean of")
        if self._sum is None:
            return self._first
        rounded = (self._sum + self._count // 2) // self._count
        return np.asarray(rounded, dtype=self._first.dtype)
