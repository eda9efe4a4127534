"""The exported folder and the pages that any run has; how they look is judged by eye."""

import json
import resource
from pathlib import Path

import pytest

from cellctl.errors.config import OutputNotWritten
from cellctl.errors.records.store import ArtefactDamaged, ExportFolderTaken, ValueRefused
from cellctl.records import RunResult, RunStore
from cellctl.records.entries import RunRecord
from cellctl.records.figures import Limit, figure
from cellctl.records.report.export import export_run, write_report
from cellctl.records.report.sections import (
    Drawing,
    FactList,
    Heading,
    ProcessPages,
    ReadArtefact,
    RecordPart,
    ReportSection,
    ReportTable,
    RowMark,
    TableCell,
    TableRow,
    Tile,
)
from cellctl.records.report.text import fixed, number
from cellctl.records.units import label
from tests.unit.records.conftest import start
from tests.unit.records.page import read, text_of
from tests.unit.records.sample import good_run


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
    assert record["process"] == "deck-to-frame"
    assert len(record["passes"]) == 3
    figures = {entry["key"]: entry for entry in record["figures"]}
    assert figures["limit_force"]["value"] == 50.0
    assert figures["peak_force"]["verdict"] == "pass"
    assert {gauge["hole"] for gauge in record["gauges"]} == {"P1", "P5"}


def test_a_run_whose_process_is_not_installed_has_a_whole_report(exported: Path) -> None:
    page = read(exported / "report.html")
    text = " ".join(page.texts)
    for expected in (
        "SAT-0042", "Good part", "Simulated", "OP-7", "cellctl 0.1.0", "ab" * 32, "cd" * 32,
        "deck-to-frame", "Transforms", "−712.300", "179.0221", "pose correction", "−0.0112",
        "Timeline", "measure deck", "5.93", "simulator", "38.4 N", "≤ 50 N", "✓ conforms",
        "812.4 N/mm", "F_peak", "residuals: P1", "this entry",
    ):  # fmt: skip
        assert expected in text, expected
    assert "script" not in page.tags
    local = [address for address in page.addresses if not address.startswith("#")]
    assert all((exported / address).is_file() for address in local)
    assert len([a for a in local if a.endswith(".png")]) == 8


def test_a_folder_takes_no_second_run(store: RunStore, tmp_path: Path) -> None:
    first, second = good_run(store), start(store)
    export_run(store, first, tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.glob("*") if path.is_file()}
    with pytest.raises(ExportFolderTaken, match=f"has run {first}, not run {second}"):
        export_run(store, second, tmp_path)
    assert {path: path.read_bytes() for path in before} == before
    export_run(store, first, tmp_path)  # the same run again, for example after a gauge


def test_a_folder_with_another_run_json_is_left_alone(store: RunStore, tmp_path: Path) -> None:
    (tmp_path / "run.json").write_text("[1, 2]", encoding="utf-8")
    with pytest.raises(ExportFolderTaken):
        export_run(store, start(store), tmp_path)
    assert (tmp_path / "run.json").read_text(encoding="utf-8") == "[1, 2]"


def test_the_last_of_several_attempts_is_shown(store: RunStore, tmp_path: Path) -> None:
    run = start(store)
    store.add(run, figure("peak", 61.25, "N", limit=Limit(upper=50.0)))
    store.add(run, figure("peak", 41.75, "N", limit=Limit(upper=50.0)))
    out = export_run(store, run, tmp_path)
    text = text_of(out)
    assert "41.75 N" in text
    assert "61.25" not in text
    record = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    assert [entry["verdict"] for entry in record["figures"]] == ["fail", "pass"]


def own_pages(record: RunRecord, read: ReadArtefact) -> ProcessPages:
    """One of everything that a process can bring."""
    size = len(read(record.artefacts[0]))
    row = TableRow((TableCell("<first>"), TableCell("17", "± 2")), RowMark.BAD, (("why", "bent"),))
    blocks = (
        Heading("heading", "careful", warning=True),
        ReportTable(("name", "amount"), (row,)),
        Drawing("<svg><title>drawn</title></svg>", "caption"),
        FactList((("bytes", str(size)),)),
    )
    return ProcessPages(
        tiles=(Tile("Brought", "by the process", "bound", True),),
        sections=(ReportSection("Own section", blocks),),
        shows=frozenset({RecordPart.PASSES, RecordPart.GAUGES}),
        tabulated=frozenset({"residuals_mm"}),
    )


def test_a_process_brings_its_pages(store: RunStore, tmp_path: Path) -> None:
    page = read(export_run(store, good_run(store), tmp_path, pages=own_pages))
    text = " ".join(page.texts)
    for expected in (
        "Brought", "Own section", "heading", "careful", "<first>", "± 2", "bent", "drawn",
        "caption", "bytes 8",
    ):  # fmt: skip
        assert expected in text, expected
    for replaced in ("Passes", "measured by", "residuals: P1"):
        assert replaced not in text, replaced
    assert "holes: P1" in text, "what the process does not show is shown for it"


def test_verdicts_can_be_read_in_a_grey_print(store: RunStore, tmp_path: Path) -> None:
    """Where a colour says good or bad, a sign says it too; where words do, there is no second."""

    def judged(_record: RunRecord, _read: ReadArtefact) -> ProcessPages:
        verdicts = {"Held": True, "Missed": False, "Noted": None}
        tiles = tuple(Tile(title, "1 mm", "", passed) for title, passed in verdicts.items())
        marks = {"kept": RowMark.GOOD, "broken": RowMark.BAD, "plain": RowMark.NONE}
        rows = [TableRow((TableCell(name), TableCell("2")), mark) for name, mark in marks.items()]
        rows.append(TableRow((TableCell("worded"), TableCell("✗ beyond")), RowMark.BAD))
        table = ReportTable(("name", "amount"), tuple(rows))
        return ProcessPages(tiles=tiles, sections=(ReportSection("Judged", (table,)),))

    page = read(export_run(store, good_run(store), tmp_path, pages=judged))
    text = " ".join(" ".join(page.shown).split())
    for expected in ("✓ Held 1 mm", "✗ Missed 1 mm", "✓ kept 2", "✗ broken 2", "worded ✗ beyond"):
        assert expected in text, expected
    for unmarked in ("Noted", "plain", "worded"):
        assert f"✓ {unmarked}" not in text
        assert f"✗ {unmarked}" not in text


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


def test_what_was_taught_or_measured_is_no_part_that_is_accepted(
    store: RunStore, tmp_path: Path
) -> None:
    run = start(store, mode="teaching")
    store.close_run(run, RunResult.GOOD)
    text = text_of(export_run(store, run, tmp_path))
    assert "Record · teaching" in text
    assert "Passed" in text
    for word in ("Good part", "Acceptance record"):
        assert word not in text


def test_an_export_that_the_disk_has_no_room_for_leaves_the_older_one_whole(
    store: RunStore, tmp_path: Path
) -> None:
    number, path = good_run(store), tmp_path / "report.html"
    write_report(store, number, path)
    whole = path.read_bytes()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(whole) // 2, limits[1]))
    try:
        with pytest.raises(OutputNotWritten, match="File too large"):
            write_report(store, number, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == whole
    assert [one.name for one in tmp_path.glob("report*")] == ["report.html"]
