"""The raw images of a run: when and how each was taken, and the rims that were measured in them."""

from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Any

from cellctl.records.entries import RunRecord
from cellctl.records.looks import MeasuredRim, TakenImage, rims_of, taken_images
from cellctl.records.report.sections import (
    Note,
    ReportSection,
    ReportTable,
    RowMark,
    TableCell,
    TableRow,
)
from cellctl.records.report.text import MISSING, fixed
from cellctl.records.run_recorder import EXPOSURES

_IMAGES = (
    "image", "taken (UTC)", "camera", "its clock ns", "pixels", "bits", "exposure ms", "gain dB",
    "mean of", "taken again",
)  # fmt: skip
_RIMS = (
    "measurement, view", "rim", "column px", "row px", "u column px", "u row px", "major axis px",
    "minor axis px", "from drawing µm", "used",
)  # fmt: skip
_OF_RIMS = (
    "Where the centre of each circle projects to, from the centre of the first pixel of the raw "
    "image; semi-axes of its ellipse; distance of the hole from its place on the registered "
    "drawing. Centres and directions of the ellipses are in the record."
)


def raw_images(record: RunRecord) -> ReportSection:
    """One row for each image; without blocks where nothing is known of any."""
    exposed: Mapping[str, Mapping[str, Any]] = record.document(EXPOSURES)
    taken = taken_images(record)
    names = dict.fromkeys((*taken, *exposed))
    rows = tuple(_image(name, taken.get(name), exposed.get(name, {})) for name in names)
    return ReportSection("Raw images", (ReportTable(_IMAGES, rows),) if rows else ())


def rims(record: RunRecord) -> ReportSection:
    """One row for each rim in each view; without blocks where no rim was kept."""
    rows = tuple(
        _rim(look, view, rim) for (look, view), found in rims_of(record).items() for rim in found
    )
    blocks = (ReportTable(_RIMS, rows), Note(_OF_RIMS)) if rows else ()
    return ReportSection("Rims in the images", blocks)


def _image(name: str, taken: TakenImage | None, exposed: Mapping[str, Any]) -> TableRow:
    exposure_s = exposed.get("exposure_s")
    texts = (
        MISSING if taken is None else f"{taken.time:%H:%M:%S.%f}"[:-3],
        _text(exposed.get("serial_number")),
        _text(exposed.get("device_time_ns")),
        _text(exposed.get("pixel_format")),
        _text(exposed.get("bits")),
        fixed(None if exposure_s is None else 1e3 * exposure_s, 3),
        fixed(exposed.get("gain_db"), 1),
        _text(exposed.get("averaged")),
        _text(exposed.get("taken_again")),
    )
    # Folder and ending, which all of them share, would push the last columns off a printed sheet.
    image = PurePosixPath(name).name.partition(".")[0]
    return TableRow((TableCell(image), *(TableCell(text) for text in texts)))


def _rim(look: str, view: str, rim: MeasuredRim) -> TableRow:
    texts = (
        rim.name,
        *(fixed(value, 3) for value in rim.centre_px),
        *(fixed(value, 4) for value in rim.sigma_px or (None, None)),
        *(fixed(value, 2) for value in rim.semi_axes_px),
        fixed(rim.residual_um, 1),
        "yes" if rim.used else "no",
    )
    cells = (TableCell(f"{look}, {view}"), *(TableCell(text) for text in texts))
    return TableRow(cells, RowMark.NONE if rim.used else RowMark.BAD)


def _text(value: object) -> str:
    return MISSING if value is None else str(value)
