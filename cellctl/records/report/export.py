"""A run as a folder that can be handed on: record, report, pictures, recordings."""

import base64
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import Any

from cellctl.errors.config import OutputNotWritten
from cellctl.errors.records.store import ExportFolderTaken, ValueRefused
from cellctl.files.atomic_files import write_durably
from cellctl.records.entered.gauges import for_programs
from cellctl.records.entered.notes import notes_of
from cellctl.records.entries import AuditEntry, RunRecord
from cellctl.records.files.artefacts import CELL_FILE
from cellctl.records.report.acceptance.runs_before import runs_before
from cellctl.records.report.pdf import to_pdf
from cellctl.records.report.render import render
from cellctl.records.report.sections import ReportBuilder, no_pages
from cellctl.records.report.view import ReportSources, ReportView, build_view
from cellctl.records.store import RunStore

REPORT, RECORD = "report.html", "run.json"


def export_run(
    store: RunStore,
    number: int,
    folder: Path,
    *,
    pages: ReportBuilder = no_pages,
    single_file: bool = False,
) -> Path:
    """Write a run into a folder and return its report.

    The folder gets ``report.html``, ``run.json`` and every file of the run under its name; with
    ``single_file`` the pictures are inside the report. ``pages`` is what the process of the run
    adds to the report. Raises ``RunUnknown``, ``ArtefactDamaged``, ``OutputNotWritten``, and
    ``ExportFolderTaken`` before anything is written.
    """
    record = store.run(number)
    _require_own(folder, record)
    addresses: dict[str, str] = {}
    for artefact in record.artefacts:
        # Names come from the record of a process: one with ``..`` would be written outside of the
        # folder.
        name = _safe(artefact.name)
        if not single_file:
            _write(folder / name, store.artefacts.get(artefact.sha256))
        if artefact.media_type.startswith("image/"):
            addresses[artefact.name] = name.as_posix()
    if single_file:
        addresses = _inside(store, record)
    view = _view(store, record, pages, addresses)
    _write(folder / REPORT, render(view).encode())
    audit = store.audit_log()
    notes = [asdict(note) for note in notes_of(number, audit)]
    plain = {
        **document(record, audit),
        "notes": notes,
        "runs_before": [asdict(one) for one in runs_before(store, record.head)],
        "ledger_head": str(view.ledger_head),
    }
    _write(folder / RECORD, (json.dumps(plain, indent=1, default=_plain) + "\n").encode())
    return folder / REPORT


def write_report(
    store: RunStore,
    number: int,
    path: Path,
    *,
    pages: ReportBuilder = no_pages,
    pdf: bool = False,
    tell: Callable[[str], None] = lambda _: None,
) -> None:
    """Write the report of a run as one file, HTML or PDF, with its pictures inside.

    ``tell`` hears how far a PDF is.
    Raises ``RunUnknown``, ``ArtefactDamaged``, ``OutputNotWritten`` and ``PdfNotMade``.
    """
    record = store.run(number)
    page = render(_view(store, record, pages, _inside(store, record)))
    _write(path, to_pdf(page, tell) if pdf else page.encode())


def _inside(store: RunStore, record: RunRecord) -> dict[str, str]:
    """Addresses of the pictures that hold their bytes, so that a report can be sent as one file."""
    return {
        artefact.name: f"data:{artefact.media_type};base64,{base64.b64encode(data).decode()}"
        for artefact in record.artefacts
        if artefact.media_type.startswith("image/")
        for data in (store.artefacts.get(artefact.sha256),)
    }


def _view(
    store: RunStore, record: RunRecord, pages: ReportBuilder, addresses: Mapping[str, str]
) -> ReportView:
    brought = pages(record, lambda artefact: store.artefacts.get(artefact.sha256))
    return build_view(record, brought, _sources(store, record, addresses))


def _sources(store: RunStore, record: RunRecord, addresses: Mapping[str, str]) -> ReportSources:
    cells = [artefact for artefact in record.artefacts if artefact.name == CELL_FILE]
    return ReportSources(
        calibrations={stored.id: stored for stored in store.calibrations()},
        audit=store.audit_log(),
        ledger_head=store.ledger_head(),
        cell=json.loads(store.artefacts.get(cells[-1].sha256)) if cells else {},
        addresses=addresses,
        before=runs_before(store, record.head),
        cell_alarms=store.cell_alarms(record.head.started, record.head.ended),
    )


def document(record: RunRecord, audit: Sequence[AuditEntry]) -> Mapping[str, Any]:
    """A run as plain data: the head's fields beside the lists; ``audit`` is the whole log."""
    fields = asdict(record)
    whole = fields.pop("head") | fields | for_programs(record, audit)
    plain: dict[str, Any] = json.loads(json.dumps(whole, default=_plain))
    return plain


def _require_own(folder: Path, record: RunRecord) -> None:
    """A folder may take the same run again, but not beside the files of another one."""
    try:
        known = json.loads((folder / RECORD).read_bytes())
        found = (known["number"], known["started"])
    except FileNotFoundError:
        return
    except (OSError, ValueError, KeyError, TypeError):
        found = ("?", "")
    if found != (record.head.number, record.head.started.isoformat()):
        raise ExportFolderTaken(f"{folder} has run {found[0]}, not run {record.head.number}")


def _safe(name: str) -> PurePosixPath:
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or not path.name:
        raise ValueRefused(f"file name {name!r} leaves the folder")
    return path


def _write(path: Path, data: bytes) -> None:
    try:
        # Whole or not at all: a folder with half of a record would be refused as that of another
        # run, also when this run is exported again.
        write_durably(path, data)
    except OSError as error:
        raise OutputNotWritten(f"{path}: {error.strerror}") from error


def _plain(value: Any) -> str:
    if isinstance(value, datetime):
        return value.isoformat()
    raise TypeError(f"{type(value).__name__} is not plain data")
