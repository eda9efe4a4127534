"""The exported folder and what the report says; how it looks is judged by eye."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from typer.testing import CliRunner

from cellctl.cli.runs import app
from cellctl.errors.records import ArtefactDamaged, RunUnknown, StoreUnavailable, ValueRefused
from cellctl.force.contact.curve import ForceCurve
from cellctl.records import RunResult, RunStore
from cellctl.records.plots import errors_by_iteration, force_by_time, force_by_travel, plug_gauges
from cellctl.records.plots.force import envelope
from cellctl.records.report import export_run
from cellctl.records.report.text import fixed, label, number
from tests.unit.records.conftest import start
from tests.unit.records.sample import force_curve, good_run

VOID = {"meta", "br", "img", "link", "hr", "input"}


class Checker(HTMLParser):
    """Open and close tags must match; collects text and addresses."""

    def __init__(self) -> None:
        super().__init__()
        self.stack: list[str] = []
        self.texts: list[str] = []
        self.addresses: list[str] = []
        self.tags: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href")]
        if tag not in VOID:
            self.stack.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        assert self.stack.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data.strip())


def read(report: Path) -> Checker:
    checker = Checker()
    checker.feed(report.read_text(encoding="utf-8"))
    assert checker.stack == []
    return checker


@pytest.fixture
def exported(store: RunStore, tmp_path: Path) -> Path:
    return export_run(store, good_run(store), tmp_path / "out").parent


def test_the_folder_holds_record_report_pictures_and_recording(exported: Path) -> None:
    names = {
        path.relative_to(exported).as_posix() for path in exported.rglob("*") if path.is_file()
    }
    assert {"report.html", "run.json", "force-1.mcap", "frame-head-1-left.png"} <= names
    record = json.loads((exported / "run.json").read_text(encoding="utf-8"))
    assert record["serial"] == "SAT-0042"
    assert len(record["iterations"]) == 3
    assert record["mating"]["limit_force_n"] == 50.0
    assert {gauge["hole"] for gauge in record["gauges"]} == {"P1", "P5"}


def test_the_report_says_what_an_auditor_asks(exported: Path) -> None:
    page = read(exported / "report.html")
    text = " ".join(page.texts)
    for expected in (
        "SAT-0042", "Good part", "Simulated", "OP-7", "cellctl 0.1.0", "ab" * 32, "cd" * 32,
        "Transforms", "−712.300", "179.0221", "−0.0112", "5.93 mm", "limit 50 N", "812.4 N/mm",
        "No", "F_peak", "this entry", "P5 outlier",
    ):  # fmt: skip
        assert expected in text, expected
    assert "script" not in page.tags
    local = [address for address in page.addresses if not address.startswith("#")]
    assert all((exported / address).is_file() for address in local)
    assert len([a for a in local if a.endswith(".png")]) == 8


def test_a_single_file_needs_no_neighbours(store: RunStore, tmp_path: Path) -> None:
    report = export_run(store, good_run(store), tmp_path / "out", single_file=True)
    page = read(report)
    assert all(address.startswith("data:image/png;base64,") for address in page.addresses)
    assert {path.name for path in report.parent.iterdir()} == {"report.html", "run.json"}


def test_a_run_that_failed_at_once_has_a_report_too(store: RunStore, tmp_path: Path) -> None:
    run = start(store, "SAT-0099")
    store.add_alarm(run, 405, "F405 <hole> not found & more")
    store.close_run(run, RunResult.ABORTED, fault_number=405, fault="F405 <hole> not found & more")
    text = " ".join(read(export_run(store, run, tmp_path)).texts)
    assert "Aborted" in text
    assert "F405 <hole> not found & more" in text
    assert "Measure and compensate" not in text
    assert "not in this store" in text


def test_an_open_run_says_so(store: RunStore, tmp_path: Path) -> None:
    text = " ".join(read(export_run(store, start(store), tmp_path)).texts)
    assert "Not closed" in text
    assert "nothing is sealed yet" in text


def test_damaged_files_and_foreign_names_are_refused(store: RunStore, tmp_path: Path) -> None:
    run = start(store)
    sha256 = store.add_artefact(run, "a.png", b"picture", "image/png")
    store.artefacts.path(sha256).write_bytes(b"other")
    with pytest.raises(ArtefactDamaged):
        export_run(store, run, tmp_path / "a")
    second = start(store)
    store.add_artefact(second, "../../evil.png", b"x", "image/png")
    with pytest.raises(ValueRefused):
        export_run(store, second, tmp_path / "b")


def test_a_recording_that_was_cut_is_shown_as_far_as_it_goes(
    store: RunStore, tmp_path: Path
) -> None:
    from datetime import UTC, datetime

    from cellctl.records.recording import MEDIA_TYPE, encode_curve

    run = start(store)
    data = encode_curve(force_curve(), datetime.now(UTC), {})
    store.add_artefact(run, "force-1.mcap", data[: len(data) // 2], MEDIA_TYPE)
    store.add_artefact(run, "force-2.mcap", b"nothing", MEDIA_TYPE)
    text = " ".join(read(export_run(store, run, tmp_path)).texts)
    assert "recording cut off" in text
    assert "force 2" not in text


def test_figures_are_well_formed_and_always_the_same(store: RunStore) -> None:
    record = store.run(good_run(store))
    curve = force_curve(seconds=2.0)
    for draw in (
        lambda: errors_by_iteration(record.iterations),
        lambda: plug_gauges(record.gauges),
        lambda: force_by_time(curve, 35.0, 50.0),
        lambda: force_by_travel(curve, None, None),
    ):
        figure = draw()
        assert ET.fromstring(figure).tag.endswith("svg")
        assert figure == draw()


def test_curves_without_samples_or_travel_are_drawn() -> None:
    empty = ForceCurve(np.zeros(0), np.zeros((0, 6)), np.zeros(0))
    assert "<svg" in force_by_time(empty, 35.0, 50.0)
    unknown = ForceCurve(np.arange(3.0), np.ones((3, 6)), np.full(3, np.nan))
    assert "<svg" in force_by_time(unknown, 35.0, 50.0)


def test_thinning_a_curve_keeps_its_peaks() -> None:
    x = np.arange(50_000.0)
    y = np.random.default_rng(1).normal(size=50_000)
    y[31_415], y[27_182] = 99.0, -99.0
    thin_x, thin_y = envelope(x, y)
    assert len(thin_x) <= 1400
    assert (thin_y.max(), thin_y.min()) == (99.0, -99.0)
    assert (np.diff(thin_x) > 0).all()


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.05, "0.05"), (0.0, "0"), (1234.5, "1234"), (-0.002512, "-0.002512"), (float("nan"), "–"),
     (812.44, "812.4"), (35.0, "35"), (1e12, "1e+12")],
)  # fmt: skip
def test_numbers(value: float, text: str) -> None:
    assert number(value) == text


def test_labels_and_columns() -> None:
    assert label("stiffness_n_per_mm") == ("stiffness", "N/mm")
    assert label("peak_moment_n_m") == ("peak moment", "N·m")
    assert label("outcome") == ("outcome", "")
    assert fixed(-0.01234, 3, signed=True) == "−0.012"
    assert fixed(None, 3) == "–"


class TestCommands:
    @pytest.fixture
    def runner(self) -> CliRunner:
        return CliRunner(env={"COLUMNS": "120", "NO_COLOR": "1"})

    @pytest.fixture
    def folder(self, store: RunStore) -> str:
        good_run(store)
        start(store, "SAT-0043")
        return str(store.path)

    def test_list(self, runner: CliRunner, folder: str) -> None:
        result = runner.invoke(app, ["list", "--data-dir", folder])
        assert result.exit_code == 0
        assert re.search(r"2\s+SAT-0043.*open", result.stdout)
        assert re.search(r"1\s+SAT-0042 \(sim\).*good", result.stdout)
        one = runner.invoke(app, ["list", "--data-dir", folder, "--serial", "SAT-0042"])
        assert "SAT-0043" not in one.stdout

    def test_show(self, runner: CliRunner, folder: str) -> None:
        result = runner.invoke(app, ["show", "1", "--data-dir", folder])
        assert result.exit_code == 0
        assert "+1.2143" in result.stdout
        assert "gauge 5.95 mm (simulator)" in result.stdout

    def test_export(self, runner: CliRunner, folder: str, tmp_path: Path) -> None:
        out = tmp_path / "handed on"
        result = runner.invoke(app, ["export", "1", "--out", str(out), "--data-dir", folder])
        assert result.exit_code == 0
        assert (out / "report.html").is_file()

    def test_gauge(self, runner: CliRunner, folder: str, store: RunStore) -> None:
        options = ["--hole", "P1", "--mm", "5.91", "--source", "OP-7", "--data-dir", folder]
        assert runner.invoke(app, ["gauge", "1", *options]).exit_code == 0
        assert {g.hole: g.diameter_mm for g in store.run(1).gauges}["P1"] == 5.91
        wrong = runner.invoke(app, ["gauge", "9", *options])
        assert isinstance(wrong.exception, RunUnknown)

    def test_verify(self, runner: CliRunner, folder: str, store: RunStore) -> None:
        good = runner.invoke(app, ["verify", "--data-dir", folder])
        assert good.exit_code == 0
        store.artefacts.path(store.run(1).artefacts[0].sha256).write_bytes(b"changed")
        bad = runner.invoke(app, ["verify", "--data-dir", folder])
        assert bad.exit_code == 1
        assert "frame-head-1-left.png" in bad.stdout

    def test_no_store(self, runner: CliRunner, tmp_path: Path) -> None:
        result = runner.invoke(app, ["list", "--data-dir", str(tmp_path / "nowhere")])
        assert isinstance(result.exception, StoreUnavailable)
        assert not (tmp_path / "nowhere").exists()
