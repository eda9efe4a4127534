"""The devices that a run was made with, and what they can be traced by."""

from collections.abc import Iterator, Mapping
from typing import Any

from cellctl.records.report.acceptance.table import NOT_STATED
from cellctl.records.report.sections import Note, ReportSection, ReportTable, TableCell, TableRow
from cellctl.records.report.text import MISSING
from cellctl.records.units import words

_MEASURING = ("robots", "stereo_cameras", "cameras", "trackers", "force_sensors")
"""Tables of the cell file whose devices have a share in what is measured."""
_COLUMNS = (
    "name",
    "kind",
    "driver",
    "connection",
    "serial number",
    "certificate",
    "told by itself",
)
_LEGEND = (
    "Serial number and certificate as the cell file states them. What is not stated is not known "
    "to the record: measured values then rest on an instrument that nothing here traces."
)


def devices(cell: Mapping[str, Any], told: Mapping[str, str]) -> ReportSection:
    """Robots and measuring devices of the cell file that the run was made with.

    ``told``: what they said of themselves when the run began, by their names.
    """
    rows = tuple(
        TableRow(tuple(TableCell(text) for text in _device(kind, name, device, told)))
        for kind in _MEASURING
        for name, device in cell.get(kind, {}).items()
    )
    table = ReportTable(_COLUMNS, rows, numbers=False)
    return ReportSection("Devices", (table, Note(_LEGEND)) if rows else ())


def _device(
    kind: str, name: str, device: Mapping[str, Any], told: Mapping[str, str]
) -> tuple[str, ...]:
    settings = device.get("settings", {})
    address = ":".join(str(settings[key]) for key in ("host", "port") if key in settings)
    return (
        name,
        words(kind).removesuffix("s"),
        str(device.get("driver", MISSING)),
        address or MISSING,
        ", ".join(_serial_numbers(device)) or NOT_STATED,
        str(device.get("certificate") or NOT_STATED),
        told.get(name) or NOT_STATED,
    )


def _serial_numbers(device: Mapping[str, Any]) -> Iterator[str]:
    """Serial number of the device, or of each camera that its settings name."""
    settings = device.get("settings", {})
    inner = (settings.get(part, {}) for part in ("left", "right", "camera"))
    for one in (device, settings, *inner):
        if isinstance(one, Mapping) and one.get("serial_number"):
            yield str(one["serial_number"])
