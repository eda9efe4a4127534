"""The drawing of the gripper's marks."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.processes.antenna_module.connector.marks import parse_marks, read_marks
from cellctl.processes.antenna_module.faults.connector import MarksFileInvalid

PATH = Path("config/connectors/gripper.toml")
TEXT = PATH.read_text()


def test_the_shipped_marks_are_read_in_si_units() -> None:
    marks = read_marks(PATH)
    assert marks.names == ("M1", "M2", "M3", "M4", "M5")
    assert marks.diameter_m == 2e-3
    assert marks.bright
    assert marks.within_rad == pytest.approx(np.radians(2.0))


def test_the_plug_lies_below_the_marks_where_the_file_says() -> None:
    text = TEXT.replace("height_mm = 0.0", "height_mm = 1.5").replace(
        "= [0.0, 0.0]", "= [1.0, 2.0]"
    )
    place = parse_marks(text.encode(), "m.toml").marks_T_connector
    assert place.translation == pytest.approx([1e-3, 2e-3, -1.5e-3])


WRONG = {
    "half a turn": ("[24.0, 2.0]", "[0.0, 0.0]", "same after half a turn"),
    "mirror": ("[24.0, 2.0]", "[24.0, 0.0]", "same in a mirror"),
    "overlap": ("[24.0, 2.0]", "[24.0, 6.0]", "overlap"),
    "twice": ('"M5"', '"M4"', "a name of its own"),
    "unknown key": ('kind = "bright"', 'sort = "bright"', "unknown key 'sort'"),
}


@pytest.mark.parametrize(("old", "new", "words"), WRONG.values(), ids=WRONG.keys())
def test_every_mistake_is_named(old: str, new: str, words: str) -> None:
    assert old in TEXT
    with pytest.raises(MarksFileInvalid, match=words):
        parse_marks(TEXT.replace(old, new, 1).encode(), "m.toml")


@given(st.binary(max_size=200))
def test_any_bytes_are_refused(content: bytes) -> None:
    with pytest.raises(MarksFileInvalid):
        parse_marks(content, "noise.toml")
