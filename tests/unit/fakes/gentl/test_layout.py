"""8-bit images in the formats of the fake cameras, read back by the driver's own decoder."""

import numpy as np
import pytest
from numpy.typing import NDArray

from drivers.camera.gige.pixels import bits_of, decoded
from fakes.gentl.formats import Format
from fakes.gentl.layout import laid_out

WIDTH, HEIGHT = 12, 6


def read(data: NDArray[np.uint8], pixel_format: Format) -> NDArray[np.uint8] | NDArray[np.uint16]:
    pixels, _ = decoded(data, pixel_format, WIDTH, HEIGHT)
    return pixels


@pytest.fixture
def grey() -> NDArray[np.uint8]:
    return np.random.default_rng(3).integers(0, 256, (HEIGHT, WIDTH), dtype=np.uint8)


@pytest.mark.parametrize("pixel_format", ["Mono8", "Mono12", "Mono12Packed"])
def test_grey_keeps_its_levels(grey: NDArray[np.uint8], pixel_format: Format) -> None:
    there = read(laid_out(grey, pixel_format), pixel_format)
    assert np.array_equal(there >> (bits_of(pixel_format) - 8), grey)


def test_colours_keep_their_levels() -> None:
    colours = np.random.default_rng(4).integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)
    assert np.array_equal(read(laid_out(colours, "RGB8"), "RGB8"), colours)


def test_a_mosaic_has_each_colour_where_the_standard_puts_it() -> None:
    """An even colour comes back everywhere; exchanged places would exchange its channels."""
    even = np.empty((HEIGHT, WIDTH, 3), dtype=np.uint8)
    even[:] = (200, 120, 40)
    assert np.array_equal(read(laid_out(even, "BayerRG8"), "BayerRG8"), even)
    assert np.array_equal(read(laid_out(even, "BayerRG12"), "BayerRG12") >> 4, even)


def test_grey_and_colour_stand_in_for_each_other(grey: NDArray[np.uint8]) -> None:
    threefold = np.stack([grey] * 3, axis=2)
    assert np.array_equal(read(laid_out(grey, "RGB8"), "RGB8"), threefold)
    assert np.array_equal(read(laid_out(threefold, "Mono8"), "Mono8"), grey)
