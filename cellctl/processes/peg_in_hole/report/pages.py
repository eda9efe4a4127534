"""The pages that an insertion adds to the report of its run."""

from collections.abc import Iterator

import numpy as np
from pydantic import ValidationError

from cellctl.cell.contact_motion.ticks import MotionKind
from cellctl.geometry.pose import MM, Array
from cellctl.processes.peg_in_hole.insertion.jam import jam_ratio
from cellctl.processes.peg_in_hole.offline.task_file import JudgedPart
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.record.tick_log import ReadTicks, read_ticks
from cellctl.processes.peg_in_hole.report.drawings import insertion_picture, search_picture
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
    (keys.SEARCH_TIME, "Search", "s", 0),
    (keys.PEAK, "Greatest force", "N", 1),
    (keys.check(DEPTH), "From its seat", "mm", 2),
    (keys.check(RESISTED), "Walls felt", "of 4", 0),
    (keys.check(SLIP), "Force over grip force", "", 2),
)


def pages(record: RunRecord, read: ReadArtefact) -> ProcessPages:
    """Headline figures, the search, the insertion."""
    sections = (
        ReportSection("Search", tuple(_search(record))),
        ReportSection("Insertion", tuple(_insertion(record, read))),
    )
    return ProcessPages(
        tiles=tuple(_tiles(record)),
        sections=tuple(section for section in sections if section.blocks),
    )


def _tiles(record: RunRecord) -> Iterator[Tile]:
    for key, title, unit, digits in _TILES:
        found = record.newest_figures.get(key)
        if found is None or found.value is None:
            continue
        passed = None if found.verdict is None else found.verdict.value == "pass"
        bound = ""
        if found.upper is not None:
            bound = f"at most {found.upper:g} {unit}"
        elif found.lower is not None:
            bound = f"at least {found.lower:g} {unit}"
        yield Tile(title, f"{found.value:.{digits}f} {unit}".rstrip(), bound.rstrip(), passed)


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


def _computed(parameter: dict[str, object]) -> str:
    value = parameter["value"]
    assert isinstance(value, float)
    return f"{quantity(value, str(parameter['unit']))} = {parameter['formula']}"


def _insertion_limit_n(record: RunRecord) -> float | None:
    """From the inputs of the guard's limits; None for runs of earlier versions."""
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
    force_n = np.stack([values[name] for name in ("fx_n", "fy_n", "fz_n")], axis=1)
    moment_n_m = np.stack([values[name] for name in ("mx_nm", "my_nm", "mz_nm")], axis=1)
    bore_mm = values["depth_mm"] - fit.hole_chamfer_mm - fit.peg_chamfer_mm
    ratio = jam_ratio(force_n, moment_n_m, bore_mm * MM, fit.peg_radius_mm * MM, fit.friction)
    if not ticks.kinds:
        return ratio
    # The pushes of the verdict go to the walls on purpose.
    return np.where(np.array(ticks.kinds) == MotionKind.FEED.value, ratio, np.nan)


def _insertion(record: RunRecord, read: ReadArtefact) -> Iterator[ReportBlock]:
    for artefact in record.artefacts:
        if artefact.name != keys.ticks(keys.INSERTION):
            continue
        try:
            ticks = read_ticks(read(artefact).decode())
        except (ValueError, UnicodeDecodeError):
            # The file is exported as it is and listed with its hash; there is nothing to draw.
            continue
        yield Drawing(
            insertion_picture(ticks.values, _insertion_limit_n(record), _jam(record, ticks)),
            "Forces of the hole on the peg along its axis and across it, and the moment across the "
            "axis about its tip, √(Mx² + My²), over the whole stream. Dashed: limit of the "
            "insertion. Shaded: a peg that slides in freely, across its axis. Jam ratio: side "
            "force and moment against what two sliding points of contact carry; from 1 on no push "
            "helps.",
        )
        if "age_ms" in ticks.values:
            trace = record.document(keys.TRACE) or {}
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
        yield FactList((("found by", result["found_by"]), ("recoveries", recoveries)))
