"""Pictures of an insertion are drawn of what was felt, and can be read without colours."""

from xml.etree import ElementTree as ET

import numpy as np

from cellctl.processes.peg_in_hole.record.tick_log import read_ticks
from cellctl.processes.peg_in_hole.report.drawings import insertion_picture, search_picture
from cellctl.processes.peg_in_hole.report.stream_picture import stream_picture
from tests.rigs.grey import confusable
from tests.unit.processes.peg_in_hole.record.test_tick_log import ticked


def test_the_way_in() -> None:
    values = read_ticks(ticked(20).text()).values
    jam = np.where(np.arange(20) > 5, 0.1 * np.arange(20), np.nan)
    for drawing in (insertion_picture(values, 30.0), insertion_picture(values, 30.0, jam)):
        assert ET.fromstring(drawing).tag.endswith("svg")
        assert confusable(drawing) == []
    assert "jam ratio" in drawing


def test_the_stream() -> None:
    contacts = [{"x_mm": 1.0, "y_mm": -2.0, "depth_mm": 0.5, "class": "end face"}]
    drawing = stream_picture(read_ticks(ticked(20).text()), contacts)
    assert ET.fromstring(drawing).tag.endswith("svg")
    assert confusable(drawing) == []
    assert "end face" in drawing
    assert "an axis at its bound" in drawing


def test_the_search_is_drawn_by_what_was_felt() -> None:
    felts = ("face", "dip", "edge", "wall", "entry")
    points = [
        {"time_s": 1.0 + n, "x_mm": n, "y_mm": -n, "depth_mm": 0.1 * n, "felt": felt}
        for n, felt in enumerate(felts)
    ]
    belief = {"reach_mm": 2.3, "weights": [[0.1, 0.2], [1.0, 0.3]]}
    contacts = [{"x_mm": 0.5, "y_mm": 0.5, "class": "side"}]
    drawing = search_picture({"points": points, "contacts": contacts}, belief)
    assert ET.fromstring(drawing).tag.endswith("svg")
    assert confusable(drawing) == []
