"""Blocks of memory for images: filled anew only after they were given back."""

import os

import numpy as np
import pytest
from numpy.typing import NDArray

from drivers.camera.gige.library_process.image_memory import MOST_FREE, ImageMemory

DESCRIPTORS = 2
"""Descriptors of a block: its own, and that of Python's mapping."""


def image(level: int, size: int = 5000) -> NDArray[np.uint8]:
    return np.full(size, level, dtype=np.uint8)


def test_a_block_is_used_again_once_it_was_given_back() -> None:
    memory = ImageMemory()
    first, second = memory.filled(image(1)), memory.filled(image(2))
    assert first != second
    memory.take_back([first])
    assert memory.filled(image(3)) == first
    assert os.pread(first, 7000, 0) == bytes([3]) * 5000
    assert os.pread(second, 7000, 0) == bytes([2]) * 5000
    memory.take_back([first, second])


def test_images_of_another_size_get_blocks_of_their_own() -> None:
    memory = ImageMemory()
    before = len(os.listdir("/proc/self/fd"))
    memory.take_back([memory.filled(image(1)), memory.filled(image(1))])
    for size in (4000, 6000):
        block = memory.filled(image(7, size))
        assert os.pread(block, 7000, 0) == bytes([7]) * size
        memory.take_back([block])
    assert len(os.listdir("/proc/self/fd")) == before + DESCRIPTORS


def test_only_some_are_kept() -> None:
    before = len(os.listdir("/proc/self/fd"))
    memory = ImageMemory()
    memory.take_back([memory.filled(image(n)) for n in range(3 * MOST_FREE)])
    assert len(os.listdir("/proc/self/fd")) == before + DESCRIPTORS * MOST_FREE
    with pytest.raises(KeyError):
        memory.take_back([0])


def test_an_image_without_a_pixel_costs_no_descriptor() -> None:
    memory, before = ImageMemory(), os.listdir("/proc/self/fd")
    with pytest.raises(ValueError, match="empty"):
        memory.filled(image(1, size=0))
    assert os.listdir("/proc/self/fd") == before
