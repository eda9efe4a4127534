"""Serial numbers that answer against those of the calibrations."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from cellctl.cli.connecting.answer import Answer
from cellctl.cli.connecting.instruments import with_instruments
from cellctl.config import load_cell
from cellctl.errors.link import ConnectTimeout

CONFIG = Path(__file__).parents[4] / "config"
SHIPPED = CONFIG / "demo-calibration"
HEAD = "stereo_cameras.head_1"


@pytest.fixture
def right() -> Answer:
    """Head I as its shipped calibration knows it."""
    made_for = json.loads((SHIPPED / "head_1.json").read_text())["serial_number"]
    assert made_for
    return Answer(HEAD, "frame-server", serial_number=made_for)


def found(answer: Answer, folder: Path = SHIPPED) -> Answer:
    (compared,) = with_instruments(load_cell(CONFIG / "deck.toml"), folder, [answer])
    return compared


def test_the_device_of_the_calibration_is_good(right: Answer) -> None:
    assert found(right) == right


def test_another_device_differs_and_names_the_calibration(right: Answer) -> None:
    (text,) = found(replace(right, serial_number="FH-0009")).differs
    assert text == (
        f"calibration head_1 was made for {right.serial_number!r}, connected is 'FH-0009'"
    )
    (fault,) = found(replace(right, serial_number="FH-0009")).faults
    assert (fault.number, fault.detail) == (741, f"{HEAD}: {text}")


def test_another_tracker_than_the_base_frame_was_measured_with_differs() -> None:
    tracker = Answer("trackers.tracker", "target-server", serial_number="ET-0001")
    assert found(tracker) == tracker
    texts = found(replace(tracker, serial_number="ET-0002")).differs
    assert [text.split(" was made for ")[0] for text in texts] == [
        "calibration base_frame",
        "calibration board_transfer",
    ]
    assert "'ET-0001', connected is 'ET-0002'" in texts[0]


def test_a_silent_device_differs_from_nothing() -> None:
    silent = Answer(HEAD, "frame-server", fault=ConnectTimeout("off"))
    assert found(silent) == silent


def test_a_calibration_that_is_missing_says_nothing_of_a_device(
    right: Answer, tmp_path: Path
) -> None:
    assert found(replace(right, serial_number="FH-0009"), tmp_path).differs == ()
