"""The pages of an assembly: drawings, holes, and everything that an auditor asks."""

import json
import re
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from math import isclose
from pathlib import Path
from types import SimpleNamespace
from typing import cast
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from cellctl.force.contact.curve import ForceCurve
from cellctl.plot_style import envelope
from cellctl.processes.deck_to_frame.poses.seat_error import SeatError
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record.entries import (
    error_figures,
    seat_limits_of,
    seat_record,
)
from cellctl.processes.deck_to_frame.record.keys import COMPONENTS
from cellctl.processes.deck_to_frame.report.acceptance import acceptance
from cellctl.processes.deck_to_frame.report.force_plot import (
    force_by_time,
    force_by_travel,
)
from cellctl.processes.deck_to_frame.report.gauge_plot import plug_gauges
from cellctl.processes.deck_to_frame.report.gauged_holes import GaugedHole, gauged_holes
from cellctl.processes.deck_to_frame.report.pages import pages
from cellctl.processes.deck_to_frame.report.pass_plot import errors_by_pass
from cellctl.processes.deck_to_frame.report.tiles import tiles
from cellctl.records import RunResult, RunStore
from cellctl.records.entries import (
    Document,
    Gauge,
    LoopPass,
    PassComponent,
    RunRecord,
    Verdict,
)
from cellctl.records.figures import Limit, figure, split_document
from cellctl.records.files.curve_file import encode_curve
from cellctl.records.files.mcap_reading import MEDIA_TYPE
from cellctl.records.parts import MATE_SERIAL, PARTS
from cellctl.records.report.acceptance.table import acceptance as acceptance_table
from cellctl.records.report.export import export_run
from cellctl.records.report.sections import ReportTable
from cellctl.records.required.required_figures import required, required_document
from tests.rigs.grey import confusable
from tests.rigs.sweeps import sweep
from tests.unit.records.conftest import start
from tests.unit.records.page import Checker, read, text_of
from tests.unit.records.sample import SIGMA, force_curve, good_run


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[RunStore, int]]:
    """A good run, which no test adds to, in its store."""
    store = RunStore(tmp_path_factory.mktemp("good") / "runs")
    yield store, good_run(store)
    store.close()


@pytest.fixture(scope="module")
def drawn(good: tuple[RunStore, int]) -> dict[Callable[[], str], str]:
    """Drawings of a good run, one with a gauge that is beyond its limit, by what draws each."""
    store, run = good
    record = store.run(run)
    assert record.passes[0].worst_ratio > 1.0, "a point beyond its threshold is drawn too"
    gauge = Gauge(datetime(2026, 1, 1, tzinfo=UTC), "P9", 5.70, "operator")
    beyond = GaugedHole(gauge, 6.0, 5.8, 6.05, Verdict.FAIL)
    curve = force_curve(seconds=2.0)
    drawings: tuple[Callable[[], str], ...] = (
        lambda: errors_by_pass(record.passes),
        lambda: plug_gauges([*gauged_holes(record), beyond]),
        lambda: force_by_time(curve, 35.0, 50.0),
        lambda: force_by_travel(curve, 35.0, 50.0),
    )
    return {draw: draw() for draw in drawings}


def test_figures_are_well_formed_and_always_the_same(drawn: dict[Callable[[], str], str]) -> None:
    for draw, drawing in drawn.items():
        assert ET.fromstring(drawing).tag.endswith("svg")
        assert drawing == draw()


def test_every_drawing_can_be_read_in_a_grey_print(drawn: dict[Callable[[], str], str]) -> None:
    for drawing in drawn.values():
        assert confusable(drawing) == []


def test_a_name_of_a_hole_is_no_formula() -> None:
    gauge = Gauge(datetime(2026, 1, 1, tzinfo=UTC), r"P$\q$", 5.97, "operator")
    assert ET.fromstring(plug_gauges([GaugedHole(gauge, 6.0, 5.8, 6.05, None)])).tag.endswith("svg")


def test_curves_without_samples_or_travel_are_drawn() -> None:
    empty = ForceCurve(np.zeros(0), np.zeros((0, 6)), np.zeros(0))
    assert "<svg" in force_by_time(empty, 35.0, 50.0)
    unknown = ForceCurve(np.arange(3.0), np.ones((3, 6)), np.full(3, np.nan))
    assert "<svg" in force_by_time(unknown, 35.0, 50.0)
    assert "<svg" in force_by_travel(force_curve(seconds=0.1), None, None), "without limits"


def test_thinning_a_curve_keeps_its_peaks() -> None:
    x = np.arange(50_000.0)
    y = np.random.default_rng(1).normal(size=50_000)
    y[31_415], y[27_182] = 99.0, -99.0
    thin_x, thin_y = envelope(x, y)
    assert len(thin_x) <= 1400
    assert (thin_y.max(), thin_y.min()) == (99.0, -99.0)
    assert (np.diff(thin_x) > 0).all()


def test_a_recording_that_was_cut_is_shown_as_far_as_it_goes(
    store: RunStore, tmp_path: Path
) -> None:
    run = start(store)
    data = encode_curve(force_curve(), datetime.now(UTC), {})
    store.add_artefact(run, "force-1.mcap", data[: len(data) // 2], MEDIA_TYPE)
    store.add_artefact(run, "force-2.mcap", b"nothing", MEDIA_TYPE)
    text = text_of(export_run(store, run, tmp_path, pages=pages))
    assert "recording cut off" in text
    assert "force 2" not in text


@dataclass(frozen=True, slots=True)
class Exported:
    """The report of a good run."""

    folder: Path
    page: Checker


@pytest.fixture(scope="module")
def exported(good: tuple[RunStore, int], tmp_path_factory: pytest.TempPathFactory) -> Exported:
    folder = tmp_path_factory.mktemp("exported") / "out"
    return Exported(folder, read(export_run(*good, folder, pages=pages)))


def test_the_report_says_what_an_auditor_asks(exported: Exported) -> None:
    page = exported.page
    text = " ".join(page.texts)
    for expected in (
        "SAT-0042", "Good part", "Simulated", "OP-7", "cellctl 0.1.0", "ab" * 32, "cd" * 32,
        "Transforms", "−712.300", "179.0221", "−0.0112", "5.93 mm", "limit 50 N", "812.4 N/mm",
        "No", "F_peak", "this entry", "P5 outlier",
    ):  # fmt: skip
        assert expected in text, expected
    assert "script" not in page.tags
    local = [address for address in page.addresses if not address.startswith("#")]
    assert all((exported.folder / address).is_file() for address in local)
    assert len([a for a in local if a.endswith(".png")]) == 8


def test_deck_and_frame_have_their_serial_numbers(store: RunStore, tmp_path: Path) -> None:
    run = start(store, "SAT-0042")
    store.add(run, Document(PARTS, {MATE_SERIAL: "FRAME-0007"}))
    text = " ".join(text_of(export_run(store, run, tmp_path / "a", pages=pages)).split())
    assert "serial number, deck SAT-0042 serial number, frame FRAME-0007" in text
    nameless = " ".join(text_of(export_run(store, start(store), tmp_path, pages=pages)).split())
    assert "serial number, frame not recorded" in nameless


def test_a_run_that_failed_at_once_has_nothing_of_an_assembly(
    store: RunStore, tmp_path: Path
) -> None:
    text = text_of(export_run(store, start(store), tmp_path, pages=pages))
    for section in ("Holes", "Measure and compensate", "Mating under force", "Pin holes"):
        assert section not in text


@pytest.mark.parametrize("ended", [RunResult.INTERRUPTED, RunResult.ABORTED, RunResult.BAD])
def test_what_a_run_has_ended_without_is_not_measured(store: RunStore, ended: RunResult) -> None:
    run = start(store)
    assert not any(group.requirements for group in acceptance(store.run(run))), "it is open"
    store.add(run, figure("peak_force", 38.4, "N", limit=Limit(upper=50.0)))
    store.close_run(run, ended)
    record = store.run(run)
    table = acceptance_table(record, acceptance(record)).blocks[0]
    assert isinstance(table, ReportTable)
    verdicts = {row.cells[0].text: row.cells[5].text for row in table.rows if len(row.cells) > 1}
    for title in ("lateral offset at the pin holes", "gap deck to frame, by vision"):
        assert verdicts[title] == "✗ not measured"
    assert verdicts["greatest force along the approach, single samples"] == "✓ conforms"


def test_every_requirement_of_a_run_that_was_cut_off_has_a_line_with_its_limit(
    store: RunStore, tmp_path: Path
) -> None:
    run = start(store)
    wanted = (
        required("pin_offsets.P1", "mm", Limit(upper=0.2)),
        required("seated_error.rx", "°", Limit(-0.02, 0.02)),
        required("hold_lateral", "N", Limit(upper=8.0)),
        required("position_error", "mm", Limit(upper=0.05)),
        required("worst_residual.seated", "µm", Limit(upper=100.0)),
        required("torque", "N·m", Limit(upper=2.0)),
    )
    store.add(run, required_document(wanted))
    store.close_run(run, RunResult.ABORTED)
    record = store.run(run)
    table = acceptance_table(record, acceptance(record)).blocks[0]
    assert isinstance(table, ReportTable)
    rows = [tuple(cell.text for cell in row.cells) for row in table.rows if len(row.cells) > 1]
    assert [(row[0], row[3]) for row in rows if row[5] == "✗ not measured"] == [
        ("lateral offset at hole P1", "≤ 0.2 mm"),
        ("rotation deck to frame about x", "± 0.02°"),
        ("lateral force while seated", "≤ 8 N"),
        ("error of the position, worst axis", "≤ 0.05 mm"),
        ("greatest residual of a hole, seated deck", "≤ 100 µm"),
        ("torque", "≤ 2 N·m"),
    ]
    text = text_of(export_run(store, run, tmp_path, pages=pages))
    assert text.count("not measured") >= len(wanted)
    assert "instead" not in text, "the document is for programs"


def test_every_axis_limit_has_a_line_of_its_own(store: RunStore) -> None:
    run = start(store)
    components = tuple(
        PassComponent(*head, value, sigma, limit)
        for head, value, sigma, limit in zip(
            COMPONENTS,
            (0.01, -0.02, 0.03, 0.0120, -0.0075, 0.001),
            SIGMA,
            (0.05, 0.05, 0.05, 0.014, 0.006, 0.006),
            strict=True,
        )
    )
    last = LoopPass("pose correction", 1, components, False)
    store.add(run, last)
    for found in error_figures(last):
        store.add(run, found)
    seat = SeatError(
        np.array([0.0, 0.0, 0.0, *np.radians([0.012, 0.008, 0.001])]),
        np.eye(6) * np.radians(0.001) ** 2,
        {},
        {},
    )
    limits = (0.02, 0.01, 0.01)
    recipe = SimpleNamespace(seated_gap_limit_mm=0.1, seated_limit_mm=0.2, seated_limits_deg=limits)
    document = seat_record(seat, cast(DeckRecipe, recipe))
    for found in split_document(document, seat_limits_of(seat, cast(DeckRecipe, recipe)))[0]:
        store.add(run, found)
    record = store.run(run)
    lines = {line.title: line for group in acceptance(record) for line in group.requirements}
    # About y the threshold is the stricter one, and is not hidden behind the greater one about x.
    assert [(lines[f"error {axis}"].required.upper, lines[f"error {axis}"].verdict) for axis in
            ("rx", "ry", "rz")] == [
        (0.014, Verdict.PASS), (0.006, Verdict.FAIL), (0.006, Verdict.PASS),
    ]  # fmt: skip
    about = [lines[f"rotation deck to frame about {axis}"] for axis in "xyz"]
    assert [line.required.upper for line in about] == pytest.approx(limits)
    assert [line.expanded for line in about] == pytest.approx([0.002] * 3)
    assert about[1].accepted.upper == pytest.approx(0.008)
    everything = acceptance_table(record, acceptance(record)).blocks[0]
    assert isinstance(everything, ReportTable)
    titles = [row.cells[0].text for row in everything.rows]
    said = {row.cells[0].text: row.cells[5].text for row in everything.rows if len(row.cells) > 1}
    # Its U leaves open on which side of the threshold it lies; that is for the loop.
    assert said["error rx"] == "within threshold, as measured"
    assert said["error ry"] == "✗ beyond threshold"
    assert not any("worst" in title or title == "rotation" for title in titles), titles
    tile = next(one for one in tiles(record, ()) if one.title == "Seated: rotation")
    assert tile.passed is not None
    errors = {one.title: one for one in tiles(replace_figures(record), ())}
    assert "ry, threshold 0.006°" in errors["Angle error"].bound
    assert errors["Angle error"].passed is False


def replace_figures(record: RunRecord) -> RunRecord:
    """The run as it is when it ended before the seat was measured."""
    return replace(record, figures=())


def test_a_plus_minus_stands_for_u_and_for_limits_alone(exported: Exported) -> None:
    page = exported.page
    limits = {"± 0.05", "± 0.005"}
    found = {text for text in page.texts if "±" in text and "U" not in text}
    assert all(any(text.startswith(one) for one in limits) for text in found), found
    text = " ".join(page.texts)
    assert "u 0.0040" in text
    assert text.count("u is a standard uncertainty") == 1
    # Noise of the samples is no uncertainty of the force: the first page says that none is known.
    assert re.search(r"final Fz [\d.]+ N, mean of the last 0.5 s", text)
    assert re.search(r"scatter of the samples in that time [\d.]+ N, one standard deviation", text)
    assert not re.search(r"\bu [\d.]+ N\b", text)


OLD = Path(__file__).parents[4] / "data" / "store-v1"


@pytest.mark.parametrize(
    "number",
    [*sweep((2, 4, 5), (5,)), *(pytest.param(number, marks=pytest.mark.long) for number in (1, 3))],
)
def test_every_number_of_an_old_report_is_in_the_new_one(tmp_path: Path, number: int) -> None:
    shutil.copytree(OLD, tmp_path / "old")
    migrated = RunStore(tmp_path / "old")
    page = read(export_run(migrated, number, tmp_path / "out", pages=pages))
    migrated.close()
    words = OLD / "expected" / f"run-{number}" / "report-words.json"
    before = numbers_of(json.loads(words.read_text(encoding="utf-8")))
    assert len(before) > 20
    after = numbers_of(page.texts)
    # Some were written with all their digits, and are written with four now.
    missing = [
        one for one in before - after if not any(isclose(one, two, rel_tol=5e-4) for two in after)
    ]
    assert missing == []


def numbers_of(texts: list[str]) -> set[float]:
    """Every number, whatever sign or word stands beside it."""
    return {float(found) for text in texts for found in re.findall(r"\d+(?:\.\d+)?", text)}
