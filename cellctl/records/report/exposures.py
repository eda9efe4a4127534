"""How the raw images of a run were exposed, one row for each."""

from collections.abc import Mapping
from typing import Any

from cellctl.records.entries import RunRecord
from cellctl.records.report.sections import (
    ReportSection,
    ReportTable,
    TableCell,
    TableRow,
)
from cellctl.records.report.text import MISSING, fixed
from cellctl.records.run_recorder import EXPOSURES

_COLUMNS = ("image", "camera", "pixels", "bits", "exposure ms", "gain dB", "mean of", "taken again")


def exposures(record: RunRecord) -> ReportSection:
    """The section; without blocks where no driver has told anything."""
    taken: Mapping[str, Mapping[str, Any]] = record.document(EXPOSURES)
    rows = tuple(_row(name, one) for name, one in taken.items())
    blocks = (ReportTable(_COLUMNS, rows),) if rows else ()
    return ReportSection("Exposures of the raw images", blocks)


def _row(name: str, one: Mapping[str, Any]) -> TableRow:
    clock = one.get("device_time_ns")
    exposure_s = one.get("exposure_s")
    texts = (
        _text(one.get("serial_number")),
        _text(one.get("pixel_format")),
        _text(one.get("bits")),
        fixed(None if exposure_s is None else 1e3 * exposure_s, 3),
        fixed(one.get("gain_db"), 1),
        _text(one.get("averaged")),
        _text(one.get("taken_again")),
    )
    image = TableCell(name, "" if clock is None else f"clock of the camera {clock} ns")
    return TableRow((image, *(TableCell(text) for text in texts)))


def _text(value: object) -> str:
    return MISSING if value is None else str(value)
