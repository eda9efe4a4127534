"""The PDF says what the HTML says, and needs nothing from outside."""

import logging
import re
import sys
from collections.abc import Iterator
from ctypes.util import find_library
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from types import ModuleType

import cv2
import numpy as np
import pytest
from pypdf import PdfReader
from typer.testing import CliRunner

from cellctl.cli.records.runs import app
from cellctl.errors.records.store import PdfNotMade
from cellctl.processes.deck_to_frame.report.pages import pages
from cellctl.records import RunResult, RunStore
from cellctl.records.entered.gauges import GAUGE_HOLES
from cellctl.records.entries import Document
from cellctl.records.figures import Limit, figure
from cellctl.records.report.export import write_report
from cellctl.records.report.pdf import to_pdf
from tests.unit.records.conftest import start
from tests.unit.records.page import read
from tests.unit.records.sample import good_run

# These begin like numbers of their own; ends of hashes are compared as words.
_NUMBER = re.compile(r"(?<![\w.])[-+−±]?\d+(?:\.\d+)?")


drawn = pytest.mark.skipif(
    find_library("pango-1.0") is None,
    reason="no Pango on this machine: apt install libpango-1.0-0 libpangoft2-1.0-0",
)


def picture() -> bytes:
    _, data = cv2.imencode(".png", np.full((40, 60, 3), 128, np.uint8))
    return data.tobytes()


def text_of_pdf(data: bytes) -> str:
    return " ".join(page.extract_text() for page in PdfReader(BytesIO(data)).pages)


@dataclass(frozen=True, slots=True)
class Recorded:
    """A good run and the PDF that the command has made of it, which takes seconds."""

    store: RunStore
    run: int
    pdf: Path
    said: str


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Recorded]:
    folder = tmp_path_factory.mktemp("recorded")
    store = RunStore(folder / "runs")
    run, pdf = good_run(store, picture()), folder / "report.pdf"
    yield Recorded(store, run, pdf, command(store, run, pdf, "--pdf"))
    store.close()


def command(store: RunStore, run: int, out: Path, *options: str) -> str:
    where = ["--data-dir", str(store.path), "--out", str(out)]
    result = CliRunner().invoke(app, ["report", str(run), *options, *where])
    assert result.exit_code == 0, result.output
    return result.stdout.strip()


@drawn
def test_every_figure_of_the_page_is_in_the_pdf(recorded: Recorded, tmp_path: Path) -> None:
    write_report(recorded.store, recorded.run, tmp_path / "report.html", pages=pages)
    page = read(tmp_path / "report.html")
    pdf = text_of_pdf(recorded.pdf.read_bytes())
    wanted = {found for text in page.shown for found in _NUMBER.findall(text)}
    assert len(wanted) > 100
    squeezed = re.sub(r"\s+", "", pdf)
    assert [number for number in sorted(wanted) if number not in squeezed] == []
    words = {word for text in page.shown for word in re.findall(r"[A-Za-z]{3,}", text)}
    assert [word for word in sorted(words) if word.lower() not in squeezed.lower()] == []
    with_pictures = [one for one in PdfReader(recorded.pdf).pages if one.images]
    assert with_pictures


@drawn
def test_the_first_page_holds_what_is_signed(recorded: Recorded) -> None:
    first = PdfReader(recorded.pdf).pages[0].extract_text()
    for expected in ("SAT-0042", "Good part", "Acceptance", "38.4 N", "k = 2", "accepted by"):
        assert expected in first, expected


@drawn
def test_the_first_page_is_signed_however_much_it_holds(store: RunStore, tmp_path: Path) -> None:
    run = start(store)
    store.add(run, Document(GAUGE_HOLES, {"P1": {"least_mm": 5.8, "most_mm": 6.0}}))
    limit = Limit(upper=99.0)
    store.add(run, *(figure(f"further_{n}", float(n), "mm", limit=limit) for n in range(60)))
    store.close_run(run, RunResult.GOOD)
    for diameter_mm in (5.70, 5.95):
        store.set_gauge(run, "P1", diameter_mm, "anna")
    told: list[str] = []
    write_report(store, run, tmp_path / "a.pdf", pages=pages, pdf=True, tell=told.append)
    first, second = (page.extract_text() for page in PdfReader(tmp_path / "a.pdf").pages[:2])
    for expected in ("Acceptance", "performed by", "inspected by", "accepted by"):
        assert expected in first, expected
    assert "accepted by" not in second
    assert "further" in second, "the table goes on overleaf"
    assert any("layout - Page 1" in step for step in told), "it says how far it is"
    assert logging.getLogger("weasyprint.progress").handlers == []


@drawn
def test_nothing_is_fetched(tmp_path: Path) -> None:
    (tmp_path / "secret.png").write_bytes(picture())
    page = f'<p>before</p><img src="file://{tmp_path}/secret.png" alt="not fetched"><p>after</p>'
    reader = PdfReader(BytesIO(to_pdf(page)))
    assert "not fetched" in reader.pages[0].extract_text()
    assert len(reader.pages[0].images) == 0


def test_a_computer_without_the_libraries_says_which(monkeypatch: pytest.MonkeyPatch) -> None:
    class Missing(ModuleType):
        def __getattr__(self, name: str) -> object:
            raise OSError("cannot load library 'libpango-1.0-0'\nand a long explanation")

    monkeypatch.setitem(sys.modules, "weasyprint", Missing("weasyprint"))
    with pytest.raises(PdfNotMade, match=r"libpango-1\.0-0'$"):
        to_pdf("<p>text</p>")


@drawn
def test_the_command_writes_one_file(recorded: Recorded, store: RunStore, tmp_path: Path) -> None:
    assert recorded.said == str(recorded.pdf)
    assert recorded.pdf.read_bytes().startswith(b"%PDF-")
    html = tmp_path / "a.html"
    assert command(store, start(store), html) == str(html)
    assert html.read_bytes().startswith(b"<!doctype html>")
