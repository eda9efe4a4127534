"""What is believed of two clocks, and of a clock that is not there."""

import math

import pytest

from cellctl.errors.camera import CamerasNotTogether
from drivers.camera.gige.config import GigeHeadConfig, Selection
from drivers.camera.gige.protocol import SentImage
from drivers.camera.gige.simultaneity import Simultaneity


def head(trigger: str, *, clocks_agree: bool) -> Simultaneity:
    config = GigeHeadConfig(
        left=Selection(serial_number="L"),
        right=Selection(serial_number="R"),
        trigger=trigger,
        max_difference_s=0.01,
        clocks_agree=clocks_agree,
    )
    return Simultaneity("head_1", config)


def image(device_s: float, *, asked_s: float = 0.0, whole_s: float = 0.1) -> SentImage:
    """0 is what a camera says that has no clock."""
    return SentImage(0, "Mono8", 4, 4, 16, round(device_s * 1e9), asked_s, whole_s)


@pytest.mark.parametrize("right_s", [0.0, 5.0])
def test_free_cameras_without_clocks_are_apart_by_what_this_pc_knows(right_s: float) -> None:
    """Two clocks that are not there agree perfectly."""
    with pytest.raises(CamerasNotTogether, match=r"100\.0 ms apart"):
        head("none", clocks_agree=True).require(image(0.0), image(right_s))


def test_free_cameras_with_clocks_that_agree_are_believed() -> None:
    head("none", clocks_agree=True).require(image(5.0), image(5.001))
    with pytest.raises(CamerasNotTogether, match=r"20\.0 ms apart"):
        head("none", clocks_agree=True).require(image(5.0), image(5.02))


def test_a_pair_without_times_says_nothing_of_the_next_one() -> None:
    triggered = head("Line1", clocks_agree=False)
    triggered.require(image(0.0, asked_s=math.nan), image(70.0, asked_s=math.nan))
    triggered.require(image(50.0, asked_s=math.nan), image(70.0, asked_s=math.nan))
    with pytest.raises(CamerasNotTogether, match=r"30\.0 ms apart"):
        triggered.require(image(51.0, asked_s=math.nan), image(71.03, asked_s=math.nan))
