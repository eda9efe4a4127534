import pytest
from pydantic import ValidationError

from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.driver import SriSensor


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"transport": "serial"}, "device"),
        ({"transport": "serial", "device": "/dev/ttyUSB0"}, "at most 371 Hz"),
        ({"transport": "can"}, "can_channel"),
        ({"transport": "can", "can_channel": "can0", "unit": "C"}, "unit E"),
        ({"transport": "udp"}, "transport"),
        ({"transport": "tcp", "filter_weights": (0, 0)}, "positive sum"),
        ({"transport": "tcp", "rate": 5}, "Extra"),
    ],
)
def test_what_does_not_fit_is_refused(settings: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        SriConfig.model_validate(settings)


def test_a_faster_line_carries_more() -> None:
    config = SriConfig(transport="serial", device="/dev/ttyUSB0", baud=460_800)
    assert config.rate_hz == 1000.0


def test_samples_of_which_newtons_are_made_are_to_be_looked_at() -> None:
    of_unit = {
        unit: SriSensor.remarks(SriConfig.model_validate({"transport": "tcp", "unit": unit}))
        for unit in ("E", "C", "M")
    }
    assert of_unit["E"] == {}
    assert "gain, zero, excitation and matrix" in of_unit["C"]["unit"]
    assert "no device has proven" in of_unit["M"]["unit"]
