"""Which grey values of an image are measured."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from cellctl.errors.vision import ImageFileInvalid
from cellctl.processes.antenna_module.vision.pixels import (
    measured_pixels,
    mosaic_plane,
    read_pixels,
)

RAMP = np.add.outer(2 * np.arange(12), 3 * np.arange(16)).astype(np.uint8)


def test_green_of_a_mosaic_moves_nothing() -> None:
    # On a ramp the mean of four neighbours is the value between them.
    mosaic = RAMP.copy()
    mosaic[0::2, 0::2] = 200
    mosaic[1::2, 1::2] = 7
    assert np.array_equal(mosaic_plane(mosaic)[1:-1, 1:-1], RAMP[1:-1, 1:-1])


@pytest.mark.parametrize(("channel", "index"), [("red", 2), ("blue", 0)])
def test_a_channel_of_a_colour_image_is_taken_as_it_is(channel: str, index: int) -> None:
    image = np.stack([RAMP, RAMP + 50, RAMP + 90], axis=2)
    taken = measured_pixels(image, channel="red" if channel == "red" else "blue")
    assert np.array_equal(taken.plane, image[:, :, index])
    assert taken.warnings


def test_a_grey_image_saved_in_colour_is_grey() -> None:
    taken = measured_pixels(np.stack([RAMP] * 3, axis=2))
    assert taken.colour is None
    assert np.array_equal(taken.plane, RAMP)


def test_other_files_are_refused(tmp_path: Path) -> None:
    deep = tmp_path / "deep.png"
    cv2.imwrite(str(deep), RAMP.astype(np.uint16))
    text = tmp_path / "text.png"
    text.write_text("no image")
    for path, words in ((deep, "uint16"), (text, "not an image"), (tmp_path / "no.png", "No such")):
        with pytest.raises(ImageFileInvalid, match=words):
            read_pixels(path)
