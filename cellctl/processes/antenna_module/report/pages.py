"""The pages that a plugging adds to the report of its run."""

import base64
from collections.abc import Iterator, Mapping, Sequence
from struct import unpack_from
from typing import Any

from cellctl.processes.antenna_module.faults.plugging import InsertionCurveInvalid
from cellctl.processes.antenna_module.insertion.curve import InsertionCurve, parse_curve
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.report.acceptance import WORDS, acceptance
from cellctl.processes.antenna_module.report.force_by_depth import force_by_depth
from cellctl.processes.antenna_module.report.terms import error_terms
from cellctl.records.entries import Figure, RunRecord
from cellctl.records.parts import mate_serial
from cellctl.records.report.sections import (
    Drawing,
    FactList,
    Heading,
    Part,
    ProcessPages,
    ReadArtefact,
    ReportBlock,
    ReportSection,
    ReportTable,
    RowMark,
    TableCell,
    TableRow,
    Tile,
)
from cellctl.records.report.text import quantity

_TILES = (
    (keys.WORST_CONTACT, "Worst contact, 99 %", 1e3, "µm", 0),
    (keys.SEAT_DEPTH, "Seat felt at", 1.0, "mm", 2),
    (keys.TOTAL, "Highest force", 1.0, "N", 1),
    (keys.PULL, "Pull test", 1.0, "N", 1),
    (keys.PLACED, "Moved on release", 1.0, "mm", 3),
)
"""Key, title, factor and unit of the tile, digits."""
_PNG_SIZES = 16
"""Bytes before the width in a PNG."""


def pages(record: RunRecord, read: ReadArtefact) -> ProcessPages:
    """Headline figures, both connectors, the plan, the insertion; of a teaching its scatter."""
    sections = (
        ReportSection("Connectors", (*_grips(record), *_pictures(record, read))),
        ReportSection("Plan", tuple(_plan(record.document(keys.PLAN)))),
        ReportSection("Insertion", tuple(_insertion(record, read))),
    )
    return ProcessPages(
        tiles=tuple(_tiles(record)),
        acceptance=acceptance(record),
        words=WORDS,
        documents=frozenset({keys.INSERTION, keys.PLAN, keys.REGRIP}),
        parts=(Part("module", record.head.serial), Part("board", mate_serial(record))),
        sections=tuple(section for section in sections if section.blocks),
    )


def _tiles(record: RunRecord) -> Iterator[Tile]:
    for key, title, factor, unit, digits in _TILES:
        found = record.newest_figures.get(key)
        if found is not None and found.value is not None:
            passed = None if found.verdict is None else found.verdict.value == "pass"
            value = f"{found.value * factor:.{digits}f} {unit}"
            yield Tile(title, value, _bound(found, factor, unit), passed)


def _bound(found: Figure, factor: float, unit: str) -> str:
    lower, upper = (
        None if bound is None else f"{bound * factor:g}" for bound in (found.lower, found.upper)
    )
    if lower is not None and upper is not None:
        return f"{lower} to {upper} {unit}"
    if upper is not None:
        return f"at most {upper} {unit}"
    return "" if lower is None else f"at least {lower} {unit}"


def _grips(record: RunRecord) -> Iterator[ReportBlock]:
    regrip = record.document(keys.REGRIP)
    if regrip:
        yield Heading("Put back and gripped again", warning=True)
        yield FactList((("the plug after the first grip", str(regrip["first_grip"])),))


def _pictures(record: RunRecord, read: ReadArtefact) -> Iterator[ReportBlock]:
    captions = {
        keys.PLUG_PICTURE: "Camera II: the plug and the marks on the gripper.",
        keys.SOCKET_PICTURE: "Camera I: the socket.",
        keys.TAUGHT_PICTURE: "Taught plugs beside their mean, and what they may scatter by.",
    }
    for artefact in record.artefacts:
        if artefact.name in captions:
            yield Drawing(_embedded(read(artefact)), captions[artefact.name])


def _embedded(png: bytes) -> str:
    """A picture within an SVG, so that the report stays one file."""
    data = base64.b64encode(png).decode()
    # The header of every PNG: signature, then the first chunk with both sizes.
    width, height = unpack_from(">II", png, _PNG_SIZES)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}">'
        f'<image width="{width}" height="{height}" '
        f'href="data:image/png;base64,{data}"/></svg>'
    )


def _plan(plan: Mapping[str, Any]) -> Iterator[ReportBlock]:
    if not plan:
        return
    yield Drawing(
        error_terms(plan["terms_um"]),
        f"Scheme {plan['scheme']}: what the predicted error of the plug is made of. 99 of 100 "
        f"plugs have contact {plan['worst_contact']}, the worst one, within {plan['p99_um']:.0f} "
        "µm of its hole.",
    )


def _insertion(record: RunRecord, read: ReadArtefact) -> Iterator[ReportBlock]:
    document = record.document(keys.INSERTION)
    limits = document.get("bounds")
    for artefact in record.artefacts:
        if artefact.name != keys.CURVE:
            continue
        curve = _curve(read(artefact))
        if curve is None:
            continue
        seat_mm = record.value(keys.SEAT_DEPTH)
        drawing = force_by_depth(curve, [] if limits is None else limits, seat_mm)
        yield Drawing(
            drawing,
            "Force on the plug in the axes of the socket; level lines: allowed.",
        )
    if document:
        suspect = document.get("suspected_contact")
        whose = f" of the {document['axes']}" if "axes" in document else ""
        words = "none" if suspect is None else f"{suspect}{whose}"
        yield Heading("Verdict", str(document["verdict"]))
        yield FactList((("suspected contact", words),))
        yield from _judged(document.get("limits", ()))


def _judged(limits: Sequence[Mapping[str, Any]]) -> Iterator[ReportBlock]:
    """What the curve was judged by."""
    rows = []
    for one in limits:
        passed, unit = bool(one["passed"]), str(one["unit"])
        sign = "≥" if one["side"] == "min" else "≤"
        texts = (
            str(one["name"]),
            quantity(one["value"], unit),
            f"{sign} {quantity(one['limit'], unit)}",
            "within" if passed else "beyond",
        )
        mark = RowMark.GOOD if passed else RowMark.BAD
        rows.append(TableRow(tuple(TableCell(text) for text in texts), mark))
    if rows:
        yield ReportTable(("of the curve", "value", "limit", "verdict"), tuple(rows), numbers=False)


def _curve(data: bytes) -> InsertionCurve | None:
    try:
        return parse_curve(data.decode())
    except (InsertionCurveInvalid, UnicodeDecodeError):
        # The file is exported as it is and listed with its hash; there is nothing to draw.
        return None
