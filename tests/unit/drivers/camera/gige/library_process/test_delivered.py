"""Where images lie in the buffers of producers that do not all say the same."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from genicam import gentl
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from drivers.camera.gige.library_process.delivered import bits_per_pixel, delivered, time_stamp
from drivers.camera.gige.pixels import decoded

MONO8, MONO12, MONO12_PACKED, MONO10P = 0x01080001, 0x01100005, 0x010C0006, 0x010A0046
IMAGE_PART, CHUNK_PART = gentl.PARTDATATYPE_IDS.PART_DATATYPE_2D_IMAGE, 7
NOTHING = SimpleNamespace()
"""A module that says nothing at all."""


def buffer(data: NDArray[np.uint8], **info: Any) -> SimpleNamespace:
    said = {"width": 4, "height": 2, "pixel_format": MONO8} | info
    return SimpleNamespace(raw_buffer=data.tobytes(), **said)


def image_of(module: SimpleNamespace, nodes: SimpleNamespace = NOTHING) -> list[list[int]]:
    found = delivered(module, nodes)
    assert found is not None
    pixels, _ = decoded(found.data, found.pixel_format, found.width, found.height)
    rows: list[list[int]] = pixels.tolist()
    return rows


RAMP = np.arange(8, dtype=np.uint8)


def test_a_plain_image_in_a_larger_buffer() -> None:
    assert image_of(buffer(np.arange(20, dtype=np.uint8))) == RAMP.reshape(2, 4).tolist()


def test_lines_with_padding() -> None:
    padded = np.full((2, 7), 99, dtype=np.uint8)
    padded[:, :4] = RAMP.reshape(2, 4)
    assert image_of(buffer(padded, padding_x=3)) == RAMP.reshape(2, 4).tolist()


def test_an_image_behind_a_header() -> None:
    data = np.concatenate([np.full(16, 99, dtype=np.uint8), RAMP])
    assert image_of(buffer(data, image_offset=16)) == RAMP.reshape(2, 4).tolist()


@pytest.mark.parametrize("number", [MONO12, MONO12_PACKED])
def test_deep_and_packed_samples(number: int) -> None:
    values = np.arange(8) * 500
    if number == MONO12:
        data = values.astype("<u2").view(np.uint8)
    else:
        first, second = values[::2], values[1::2]
        middle = first & 15 | (second & 15) << 4
        data = np.stack([first >> 4, middle, second >> 4], axis=1).astype(np.uint8).ravel()
    assert image_of(buffer(data, pixel_format=number)) == values.reshape(2, 4).tolist()


def test_the_high_byte_first() -> None:
    values = np.arange(8) * 500
    big = gentl.PIXELENDIANNESS_IDS.PIXELENDIANNESS_BIG
    data = values.astype(">u2").view(np.uint8)
    module = buffer(data, pixel_format=MONO12, pixel_endianness=big)
    assert image_of(module) == values.reshape(2, 4).tolist()


def test_what_the_producer_does_not_say_the_camera_does() -> None:
    pixel_format = SimpleNamespace(get_int_value=lambda: MONO8)
    size = {name: SimpleNamespace(value=value) for name, value in (("Width", 4), ("Height", 2))}
    nodes = SimpleNamespace(PixelFormat=pixel_format, **size)
    assert (
        image_of(SimpleNamespace(raw_buffer=RAMP.tobytes()), nodes) == RAMP.reshape(2, 4).tolist()
    )


def test_the_image_among_several_parts() -> None:
    data = np.concatenate([np.full(10, 99, dtype=np.uint8), RAMP])
    chunk = SimpleNamespace(data_type=CHUNK_PART, data_offset=0)
    image = SimpleNamespace(
        data_type=IMAGE_PART, data_offset=10, data_format=MONO8, width=4, height=2
    )
    module = buffer(data, parts=[chunk, image], width=99, height=99)
    assert image_of(module) == RAMP.reshape(2, 4).tolist()
    assert delivered(buffer(data, parts=[chunk]), NOTHING) is None


def test_a_format_without_a_name_is_shown_by_its_number() -> None:
    found = delivered(buffer(RAMP, pixel_format=0x81080ABC), NOTHING)
    assert found is not None
    assert found.pixel_format == "0x81080ABC"


@given(
    st.binary(max_size=40),
    st.integers(0, 12),
    st.integers(0, 8),
    st.sampled_from([MONO8, MONO12, MONO10P]),
)
def test_a_buffer_that_is_too_small_is_refused(
    data: bytes, padding: int, offset: int, number: int
) -> None:
    module = buffer(
        np.frombuffer(data, dtype=np.uint8),
        padding_x=padding,
        image_offset=offset,
        pixel_format=number,
    )
    needed = offset + 2 * (4 * bits_per_pixel(number) // 8 + padding)
    if len(data) < needed:
        with pytest.raises(ValueError, match="bytes of buffer"):
            delivered(module, NOTHING)
    else:
        assert len(image_of(module)) == 2


def test_times_in_ns_and_in_ticks() -> None:
    device = SimpleNamespace(timestamp_frequency=125_000_000)
    nodes = SimpleNamespace(GevTimestampTickFrequency=SimpleNamespace(value=62_500_000))
    ticks = SimpleNamespace(timestamp=1_000_000)
    assert time_stamp(SimpleNamespace(timestamp_ns=5, timestamp=7), device, nodes) == (5, 5)
    assert time_stamp(ticks, device, nodes) == (1_000_000, 8_000_000)
    assert time_stamp(ticks, NOTHING, nodes) == (1_000_000, 16_000_000)
    assert time_stamp(ticks, NOTHING, NOTHING) == (1_000_000, 0)
    assert time_stamp(NOTHING, NOTHING, NOTHING) == (0, 0)
