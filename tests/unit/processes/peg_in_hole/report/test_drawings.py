"""Pictures of an insertion are drawn of what was felt, and can be read without colours."""

from xml.etree import ElementTree as ET

from cellctl.processes.peg_in_hole.record.tick_log import read_ticks
from cellctl.processes.peg_in_hole.report.drawings import insertion_picture, search_picture
from tests.rigs.grey import confusable
from tests.unit.processes.peg_in_hole.record.test_tick_log import ticked


def test_the_way_in() -> None:
    drawing = insertion_picture(read_ticks(ticked(20).text()), 30.0)
    assert ET.fromstring(drawing).tag.endswith("svg")
    assert confusable(drawing) == []


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
