"""The holes of one measurement, as a table of the report."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from cellctl.records.entries import RecordedPose
from cellctl.records.report.sections import (
    Heading,
    ReportBlock,
    ReportTable,
    RowMark,
    TableCell,
    TableRow,
)
from cellctl.records.report.text import MISSING, fixed
from cellctl.records.units import words

HOLES, RESIDUALS, OUTLIERS = "holes", "residuals_mm", "outliers"
TABULATED = frozenset({HOLES, RESIDUALS})
"""Details of a measurement that the table shows; outliers are named below the pose, too."""
_COLUMNS = (
    "hole", "head", "x mm", "y mm", "z mm", "σ µm", "diameter mm", "residual µm",
)  # fmt: skip


def hole_blocks(entries: Sequence[RecordedPose]) -> Iterator[ReportBlock]:
    """A heading and a table for every measurement that names its holes."""
    for entry in entries:
        holes = entry.detail.get(HOLES, {})
        if holes:
            yield Heading(words(entry.key), "position in the left camera of the head")
            yield ReportTable(_COLUMNS, tuple(_rows(entry.detail, holes)))


def _rows(detail: Mapping[str, Any], holes: Mapping[str, Mapping[str, Any]]) -> Iterator[TableRow]:
    residuals, outliers = detail.get(RESIDUALS, {}), detail.get(OUTLIERS, ())
    for name, hole in holes.items():
        outlier = name in outliers
        residual_mm = residuals.get(name)
        residual = MISSING if residual_mm is None else fixed(math.hypot(*residual_mm) * 1e3, 1)
        texts = (
            f"{name} outlier" if outlier else name,
            str(hole.get("head", MISSING)),
            *(fixed(value, 3) for value in hole.get("position_mm", (None,) * 3)),
            # Root of the summed variances: one number for a position of three components.
            fixed(math.hypot(*hole.get("sigma_mm", (math.nan,))) * 1e3, 1),
            fixed(hole.get("diameter_mm"), 3),
            residual,
        )
        cells = tuple(TableCell(text) for text in texts)
        yield TableRow(cells, RowMark.BAD if outlier else RowMark.NONE)
