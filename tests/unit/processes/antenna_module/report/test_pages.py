"""What the report of a plugging shows, from the record alone."""

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from cellctl.processes.antenna_module.insertion.curve import curve_text, parse_curve
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.report.force_by_depth import force_by_depth
from cellctl.processes.antenna_module.report.pages import pages
from cellctl.records import RunStore
from cellctl.records.entries import Document
from cellctl.records.figures import Limit, figure
from cellctl.records.report.export import export_run
from tests.rigs.antenna.curves import curve
from tests.rigs.grey import confusable
from tests.unit.records.conftest import start
from tests.unit.records.page import text_of

PLAN = {
    "scheme": "difference",
    "worst_contact": "8",
    "p99_um": 34.6,
    "terms_um": {"look_plug": 2.1, "approach": 8.0, "correction": 4.4},
}
VERDICT = {
    "verdict": "bent_pin",
    "suspected_contact": "11",
    "axes": "socket micro-d-15",
    "bounds": [[-1.0, 0.5, 3.0]],
    "limits": [
        {
            "name": "side force",
            "value": 4.25,
            "limit": 3.0,
            "unit": "N",
            "side": "max",
            "passed": False,
        }
    ],
}


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


def png() -> bytes:
    _, data = cv2.imencode(".png", np.zeros((34, 90, 3), np.uint8))
    return data.tobytes()


def test_the_force_can_be_read_in_a_grey_print() -> None:
    drawing = force_by_depth(parse_curve(curve_text(curve())), [(-1.0, 0.5, 3.0)], 2.5)
    assert confusable(drawing) == []


def test_connectors_plan_and_insertion(store: RunStore, tmp_path: Path) -> None:
    run = start(store)
    store.add(
        run,
        Document(keys.PLAN, PLAN),
        Document(keys.INSERTION, VERDICT),
        figure(keys.WORST_CONTACT, 0.0346, "mm", limit=Limit(upper=0.05)),
        figure(keys.SEAT_DEPTH, 2.5, "mm", limit=Limit(2.35, 2.65)),
        figure(keys.PULL, 3.1, "N", limit=Limit(lower=3.0)),
        figure(keys.PLACED, 0.02, "mm", limit=Limit(upper=0.1)),
    )
    store.add_artefact(run, keys.PLUG_PICTURE, png(), "image/png")
    store.add_artefact(run, keys.SOCKET_PICTURE, png(), "image/png")
    store.add_artefact(run, keys.CURVE, curve_text(curve()).encode(), "text/csv")
    report = export_run(store, run, tmp_path, pages=pages)
    text = " ".join(text_of(report).split())
    for words in (
        "35 µm",
        "11 of the socket micro-d-15",
        "at most 50 µm",
        "2.35 to 2.65 mm",
        "at least 3 N",
        "contact 8, the worst one, within 35 µm",
        "Camera II: the plug",
        "Camera I: the socket",
        "bent_pin",
        "Force on the plug",
        "side force 4.25 N ≤ 3 N beyond",
        "lateral offset of the module",
        "serial number, module SAT-0001",
        "serial number, board not recorded",
    ):
        assert words in text, words
    text = report.read_text(encoding="utf-8")
    assert text.count("data:image/png;base64") == 2
    # As large as the pictures are, so that no empty frame surrounds them.
    assert text.count('viewBox="0 0 90 34"') == 2


def test_a_second_grip_is_told_with_what_was_wrong_with_the_first(
    store: RunStore, tmp_path: Path
) -> None:
    run = start(store)
    store.add(run, Document(keys.REGRIP, {"first_grip": "2.51 mm from where it should be"}))
    text = text_of(export_run(store, run, tmp_path, pages=pages))
    assert "Put back and gripped again" in text
    assert "2.51 mm from where it should be" in text


def test_a_teaching_shows_its_scatter(store: RunStore, tmp_path: Path) -> None:
    run = start(store)
    store.add_artefact(run, keys.TAUGHT_PICTURE, png(), "image/png")
    report = export_run(store, run, tmp_path, pages=pages)
    assert "Taught plugs beside their mean" in text_of(report)
    assert report.read_text(encoding="utf-8").count("data:image/png;base64") == 1


def test_a_run_that_ended_before_its_plan(store: RunStore, tmp_path: Path) -> None:
    run = start(store)
    text = text_of(export_run(store, run, tmp_path, pages=pages)).lower()
    assert "worst contact" not in text
    assert "insertion" not in text


def test_a_curve_that_was_cut_is_left_out(store: RunStore, tmp_path: Path) -> None:
    run = start(store)
    store.add(run, Document(keys.INSERTION, VERDICT))
    data = curve_text(curve()).encode()
    store.add_artefact(run, keys.CURVE, data[:60], "text/csv")
    text = text_of(export_run(store, run, tmp_path, pages=pages)).lower()
    assert "bent_pin" in text
    assert "force on the plug" not in text
