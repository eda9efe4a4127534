"""A fault of an image names the device that took it."""

import pytest

from cellctl.cell.image_faults import naming
from cellctl.errors.vision import (
    CamerasSwapped,
    CameraUpsideDown,
    HoleMissing,
    ImageBlack,
    ImageBlurred,
    ImageSaturated,
    ImageSizeMismatch,
    VisionError,
)


@pytest.mark.parametrize(
    "fault",
    [
        ImageSizeMismatch,
        ImageBlack,
        ImageSaturated,
        ImageBlurred,
        CamerasSwapped,
        CameraUpsideDown,
    ],
)
def test_a_fault_of_an_image_begins_with_its_device(fault: type[VisionError]) -> None:
    with pytest.raises(VisionError) as raised, naming("head_1"):
        raise fault("left: of some kind")
    assert type(raised.value) is fault
    assert raised.value.detail == "head_1, left: of some kind"


def test_a_fault_of_the_part_stays_as_it_is() -> None:
    with pytest.raises(HoleMissing) as raised, naming("head_1"):
        raise HoleMissing("P5")
    assert raised.value.detail == "P5"
