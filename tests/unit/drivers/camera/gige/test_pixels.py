"""Pixel formats as their standard lays them out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from cellctl.interfaces.camera import PixelFormat
from drivers.camera.gige.pixels import bits_of, decoded, grey

RAMP = np.arange(48, dtype=np.uint16).reshape(6, 8)


def raw(*values: int) -> NDArray[np.uint8]:
    return np.array(values, dtype=np.uint8)


def test_golden_bytes_of_packed_formats() -> None:
    """PFNC 2.4, 8.3: 0x123 and 0x456; GigE Vision 2.0, 27.1: high bytes outside, nibbles inside."""
    pixels, kind = decoded(raw(0x23, 0x61, 0x45), "Mono12p", 2, 1)
    assert (pixels.tolist(), kind) == ([[0x123, 0x456]], PixelFormat.MONO16)
    pixels, _ = decoded(raw(0x12, 0x63, 0x45), "Mono12Packed", 2, 1)
    assert pixels.tolist() == [[0x123, 0x456]]
    pixels, _ = decoded(raw(0x48, 0x23, 0x15), "Mono10Packed", 2, 1)
    assert pixels.tolist() == [[0x48 << 2 | 3, 0x15 << 2 | 2]]
    pixels, _ = decoded(raw(0x01, 0x08, 0x30, 0x00, 0x01), "Mono10p", 4, 1)
    assert pixels.tolist() == [[1, 2, 3, 4]]
    pixels, _ = decoded(raw(0x34, 0x02), "Mono10", 1, 1)
    assert pixels.tolist() == [[0x234]]


@given(st.lists(st.integers(0, 1023), min_size=4, max_size=40))
def test_packed_samples_come_back(values: list[int]) -> None:
    bits = np.array([[value >> bit & 1 for bit in range(10)] for value in values], dtype=np.uint8)
    data = np.packbits(bits.ravel(), bitorder="little")
    pixels, _ = decoded(data, "Mono10p", len(values), 1)
    assert pixels.ravel().tolist() == values


@pytest.mark.parametrize(
    ("name", "red_first"), [("RGB8", True), ("BGR8", False), ("RGBa8", True), ("BGRa8", False)]
)
def test_colours_come_red_first(name: str, red_first: bool) -> None:
    sent = [200, 100, 50] if red_first else [50, 100, 200]
    data = raw(*sent, *([255] if "a8" in name else []))
    pixels, kind = decoded(data, name, 1, 1)
    assert (pixels.tolist(), kind) == ([[[200, 100, 50]]], PixelFormat.RGB8)
    deep = np.array(sent + ([4095] if "a8" in name else []), dtype="<u2") * 16
    pixels, kind = decoded(deep.view(np.uint8), name.replace("8", "12"), 1, 1)
    assert (pixels.tolist(), kind) == ([[[3200, 1600, 800]]], PixelFormat.RGB16)


@pytest.mark.parametrize("pattern", ["RG", "GR", "GB", "BG"])
def test_a_mosaic_of_a_red_scene_is_red(pattern: str) -> None:
    """Whatever the order of its pixels: only those under a red filter see light."""
    mosaic = np.zeros((8, 8), dtype=np.uint8)
    row, column = divmod({"RG": 0, "GR": 1, "GB": 2, "BG": 3}[pattern], 2)
    mosaic[row::2, column::2] = 200
    pixels, kind = decoded(mosaic.ravel(), f"Bayer{pattern}8", 8, 8)
    assert kind is PixelFormat.RGB8
    assert pixels[3:5, 3:5, 0].min() > 150
    assert pixels[3:5, 3:5, 1:].max() == 0
    deep = mosaic.astype("<u2") * 20
    pixels, kind = decoded(deep.ravel().view(np.uint8), f"Bayer{pattern}12", 8, 8)
    assert kind is PixelFormat.RGB16
    assert pixels.dtype == np.uint16
    assert pixels[3:5, 3:5, 0].min() == 4000
    assert pixels[3:5, 3:5, 1:].max() == 0


@pytest.mark.parametrize("bits", [10, 12])
def test_a_packed_mosaic_keeps_its_bits(bits: int) -> None:
    level = (1 << bits) - 3
    streams = np.array([[level >> bit & 1 for bit in range(bits)]] * 16, dtype=np.uint8)
    data = np.packbits(streams.ravel(), bitorder="little")
    pixels, kind = decoded(data, f"BayerGR{bits}p", 4, 4)
    assert (kind, pixels.min(), pixels.max()) == (PixelFormat.RGB16, level, level)
    assert grey(pixels, kind, bits).min() == 255


def test_grey_keeps_the_high_bits() -> None:
    deep, kind = decoded((RAMP * 64).astype("<u2").view(np.uint8).ravel(), "Mono12", 8, 6)
    assert grey(deep, kind, bits_of("Mono12")).tolist() == (RAMP * 4).tolist()
    white = np.full((2, 2, 3), 255, dtype=np.uint8)
    assert grey(white, PixelFormat.RGB8, 8).tolist() == [[255, 255], [255, 255]]


OTHERS = (
    "YUV422_8 Coord3D_ABC32f Mono1p Bayer Mono8s RGB8_Planar RGB10p32 RGB12p RGB565p Mono14Packed "
    "Mono16p BayerRG8s RGBa Mono10c3a32"
)


@pytest.mark.parametrize("name", ["", *OTHERS.split()])
def test_other_formats_are_refused_with_those_that_are_read(name: str) -> None:
    with pytest.raises(ValueError, match="supported are Mono"):
        decoded(np.zeros(1000, dtype=np.uint8), name, 4, 4)


@given(st.binary(max_size=64), st.sampled_from(["Mono8", "Mono12p", "Mono12Packed", "BayerRG8"]))
def test_too_few_bytes_are_refused(data: bytes, name: str) -> None:
    with pytest.raises(ValueError, match="bytes of image"):
        decoded(np.frombuffer(data, dtype=np.uint8), name, 16, 8)
