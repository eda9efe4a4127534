"""The pages that an insertion adds to the report of its run."""

from collections.abc import Iterator

import numpy as np
from pydantic import ValidationError

from cellctl.cell.contact_motion.ticks import MotionKind
from cellctl.geometry.pose import MM, Array
from cellctl.processes.peg_in_hole.insertion.jam import jam_ratio
from cellctl.processes.peg_in_hole.insertion.past_seat import SEAT_TOLERANCE_M
from cellctl.processes.peg_in_hole.offline.task_file import JudgedPart
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.record.tick_log import ReadTicks, read_ticks
from cellctl.processes.peg_in_hole.report.acceptance import WORDS, acceptance, slip_forces
from cellctl.processes.peg_in_hole.report.drawings import insertion_picture, search_picture
from cellctl.processes.peg_in_hole.report.found import contact_table, evidence_facts
from cellctl.processes.peg_in_hole.report.stream_picture import stream_picture
from cellctl.processes.peg_in_hole.verdict.judgement import DEPTH, RESISTED, SLIP
from cellctl.records.entries import RunRecord
from cellctl.records.report.sections import (
    Drawing,
    FactList,
    ProcessPages,
    ReadArtefact,
    ReportBlock,
    ReportSection,
    Tile,
)
from cellctl.records.report.text import quantity

_TILES = (
    (keys.PEAK, "Greatest force", "N", 1),
    (keys.check(DEPTH), "From its seat", "mm", 2),
    (keys.check(RESISTED), "Walls felt", "of 4", 0),
    (keys.check(SLIP), "Force over grip force", "", 2),
)
_SHOWN = frozenset({keys.CHOICE, keys.CYCLE, keys.TRACE, keys.MAP, keys.FAILURE})
"""Documents that the sections show."""
_JAM = (
    " Jam ratio: side force and moment against what two sliding points of contact carry; from 1 on "
    "no push helps. It is drawn to 0.3 mm before the seat: where the force of the seat only begins "
    "it may be more, and says nothing of the walls."
)


def pages(record: RunRecord, read: ReadArtefact) -> ProcessPages:
    """Headline figures, the requirements, the search, the insertion."""
    sections = (
        ReportSection("Search", tuple(_search(record))),
        ReportSection("Insertion", tuple(_insertion(record, read))),
    )
    return ProcessPages(
        tiles=tuple(_tiles(record, read)),
        acceptance=acceptance(record),
        words=WORDS,
        documents=_SHOWN,
        sections=tuple(section for section in sections if section.blocks),
    )


def _tiles(record: RunRecord, read: ReadArtefact) -> Iterator[Tile]:
    yield from _search_tile(record)
    if keys.PEAK not in record.newest_figures:
        yield from _pressed(record, read)
    for key, title, unit, digits in _TILES:
        found = record.newest_figures.get(key)
        if found is None or found.value is None:
            continue
        passed = None if found.verdict is None else found.verdict.value == "pass"
        bounds = [slip_forces(record)] if key == keys.check(SLIP) else []
        if found.upper is not None:
            bounds.append(f"at most {found.upper:g} {unit}".rstrip())
        elif found.lower is not None:
            bounds.append(f"at least {found.lower:g} {unit}".rstrip())
        bound = ", ".join(filter(None, bounds))
        yield Tile(title, f"{found.value:.{digits}f} {unit}".rstrip(), bound, passed)


def _search_tile(record: RunRecord) -> Iterator[Tile]:
    """How long it took; of one that was cut off only that, for its touches say nothing of it."""
    failure, searched_s = record.document(keys.FAILURE), record.value(keys.SEARCH_TIME)
    found = bool(failure and failure["found_by"]) or keys.PEAK in record.newest_figures
    if found and searched_s is not None:
        yield Tile("Search", f"{searched_s:.0f} s", "", None)
    elif keys.TOUCHES in record.newest_figures:
        touches = f"{record.value(keys.TOUCHES):.0f} touches of the search"
        yield Tile("Search", "not ended", touches, None)


def _pressed(record: RunRecord, read: ReadArtefact) -> Iterator[Tile]:
    """How hard a part was pressed whose insertion came to no end."""
    pressed = [
        float(-ticks.values["fz_n"].min())
        for stream in (keys.FACE, keys.INSERTION)
        if (ticks := _ticks(record, read, stream)) is not None
    ]
    if pressed:
        words = "along the axis, until the run ended"
        yield Tile("Greatest force felt", f"{max(pressed):.1f} N", words, None)


def _search(record: RunRecord) -> Iterator[ReportBlock]:
    choice, trace = record.document(keys.CHOICE), record.document(keys.TRACE)
    if choice:
        yield FactList(
            (
                ("strategies, in their order", ", ".join(choice["order"])),
                # Of the searches that were not chosen, too: the times say why.
                *((f"estimate, {one['name']}", _computed(one)) for one in choice["estimates"]),
                *(
                    (one["name"], _computed(one))
                    for one in choice["parameters"] + choice.get("guard", [])
                ),
            )
        )
    if trace and trace["points"]:
        yield Drawing(
            search_picture(trace, record.document(keys.MAP)),
            "Left: where the peg touched the face, by what was felt; crosses are classified "
            "contacts; dark is where the hole is still believed. Right: depth of each touch.",
        )
    if trace and trace.get("contacts"):
        yield contact_table(trace["contacts"])


def _computed(parameter: dict[str, object]) -> str:
    value = parameter["value"]
    assert isinstance(value, float)
    return f"{quantity(value, str(parameter['unit']))} = {parameter['formula']}"


def _insertion_limit_n(record: RunRecord) -> float | None:
    """Limit of the insertion from the inputs of the guard's limits; None in runs of earlier
    versions."""
    choice = record.document(keys.CHOICE) or {}
    for limit in choice.get("guard", []):
        if "F_i" in limit.get("inputs", {}):
            return float(limit["inputs"]["F_i"])
    return None


def _jam(record: RunRecord, ticks: ReadTicks) -> Array | None:
    """Ratio of each tick of a feed; None for runs of other versions, whose task says less."""
    written = record.document(keys.TASK)
    if not written:
        return None
    try:
        part = JudgedPart.model_validate(written)
    except ValidationError:
        # Of another version: the report shows all the rest of the run.
        return None
    fit, values = part.fit, ticks.values
    seat_mm = fit.depth_mm - SEAT_TOLERANCE_M / MM
    force_n = np.stack([values[name] for name in ("fx_n", "fy_n", "fz_n")], axis=1)
    moment_n_m = np.stack([values[name] for name in ("mx_nm", "my_nm", "mz_nm")], axis=1)
    bore_mm = values["depth_mm"] - fit.hole_chamfer_mm - fit.peg_chamfer_mm
    ratio = jam_ratio(force_n, moment_n_m, bore_mm * MM, fit.peg_radius_mm * MM, fit.friction)
    told = values["depth_mm"] < seat_mm
    if ticks.kinds:
        # The pushes of the verdict go to the walls on purpose.
        told &= np.array(ticks.kinds) == MotionKind.FEED.value
    ratio = np.where(told, ratio, np.nan)
    return ratio if np.isfinite(ratio).any() else None


def _ticks(record: RunRecord, read: ReadArtefact, stream: str) -> ReadTicks | None:
    """The ticks of a stream; None where the run has none that can be read."""
    for artefact in record.artefacts:
        if artefact.name == keys.ticks(stream):
            try:
                return read_ticks(read(artefact).decode())
            except (ValueError, UnicodeDecodeError):
                # The file is exported as it is and listed with its hash; there is nothing to draw.
                return None
    return None


def _insertion(record: RunRecord, read: ReadArtefact) -> Iterator[ReportBlock]:
    ticks = _ticks(record, read, keys.INSERTION)
    if ticks is not None:
        jam = _jam(record, ticks)
        of_jam = "" if jam is None else _JAM
        yield Drawing(
            insertion_picture(ticks.values, _insertion_limit_n(record), jam),
            "Forces of the hole on the peg along its axis and across it, and the moment across the "
            "axis about its tip, √(Mx² + My²), over the whole stream. Dashed: limit of the "
            f"insertion. Shaded: a peg that slides in freely, across its axis.{of_jam}",
        )
        if "age_ms" in ticks.values:
            trace = record.document(keys.TRACE)
            yield Drawing(
                stream_picture(ticks, trace.get("contacts", [])),
                "What the arm did, with the classes of the first contacts; depth of the tip; its "
                "speed as commanded, and where an axis had given way as far as it may; age of the "
                "ticks and of the newest force at each.",
            )
    failure, result = record.document(keys.FAILURE), record.document(keys.CYCLE)
    if failure:
        found_by = failure["found_by"] or "not found"
        yield FactList((("hole", found_by), ("ended by", failure["fault"])))
    if result:
        recoveries = ", ".join(result["recoveries"]) or "none"
        facts = (("found by", result["found_by"]), ("recoveries", recoveries))
        yield FactList((*facts, *evidence_facts(result)))
