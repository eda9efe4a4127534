"""Composes the recording of a run from its record."""

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from foxglove_schemas_protobuf.Log_pb2 import Log

from cellctl.errors.records.store import RecordNotWritten
from cellctl.records.entered.gauges import PART_VERDICT, part_verdict
from cellctl.records.entries import RunRecord
from cellctl.records.report.acceptance.timeline import during
from cellctl.records.report.export import document
from cellctl.records.run_mcap.file_writer import RunFileWriter
from cellctl.records.run_mcap.findings import figures, passes, poses
from cellctl.records.run_mcap.frames import calibrated_frames
from cellctl.records.run_mcap.happenings import alarms, commands, log, states_in_log, steps
from cellctl.records.run_mcap.images import ImageForm, images
from cellctl.records.run_mcap.message import TimedMessage, nanoseconds
from cellctl.records.run_mcap.motion import contact_forces, recorded_motion
from cellctl.records.run_mcap.sources import RunSources
from cellctl.records.store import RunStore

RUN, MISSING = "run", "missing"
"""Names of the metadata."""


@dataclass(frozen=True, slots=True)
class ExportedRun:
    """What a file has, and what it lacks."""

    path: Path
    messages: Mapping[str, int]
    """Number of messages, by topic."""
    frames: frozenset[str]
    """Names of the frames in the tree of transforms."""
    missing: tuple[str, ...]
    """Empty when all that the record names is in the file."""


def export_mcap(
    store: RunStore, number: int, path: Path, form: ImageForm = ImageForm.LOSSLESS
) -> ExportedRun:
    """Write a run as one file, in the place of an older one.

    What is damaged or was not recorded is left out and named in the result, in the metadata and
    in the log of the file. Raises ``RunUnknown`` and ``RecordNotWritten``.
    """
    record, audit = store.run(number), store.audit_log()
    used = set(record.head.calibration_ids.values())
    sources = RunSources(
        record,
        during(record, audit),
        [one for one in store.calibrations() if one.id in used],
        store.artefacts,
    )
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as stream:
            writer = RunFileWriter(stream)
            _write(writer, sources, document(record, audit), form)
        part.replace(path)
    except BaseException as error:
        # Also where somebody has interrupted it: hundreds of megabytes that nobody looks for. The
        # fault is that of the file; what is left of it must not hide it.
        with suppress(OSError):
            part.unlink()
        if not isinstance(error, OSError):
            raise
        raise RecordNotWritten(f"{path}: {error.strerror}") from error
    return ExportedRun(path, dict(writer.written), frozenset(writer.frames), tuple(sources.missing))


def _write(
    writer: RunFileWriter, sources: RunSources, run_json: Mapping[str, Any], form: ImageForm
) -> None:
    record = sources.record
    messages = sorted(_messages(sources, form), key=lambda message: message.time_ns)
    writer.metadata(RUN, _head(record))
    for message in messages:
        writer.add(message)
    last_ns = messages[-1].time_ns
    for text in sources.missing:
        writer.add(log(last_ns, MISSING, f"missing: {text}", Log.WARNING))
    if sources.missing:
        lines = {f"{index:03d}": text for index, text in enumerate(sources.missing, start=1)}
        writer.metadata(MISSING, lines)
    whole = json.dumps(run_json, indent=1).encode()
    writer.attach("run.json", record.head.ended or record.head.started, "application/json", whole)
    writer.finish()


def _messages(sources: RunSources, form: ImageForm) -> Iterator[TimedMessage]:
    record = sources.record
    yield from _opened_and_closed(sources)
    yield from calibrated_frames(sources.calibrations, record)
    motion = list(recorded_motion(sources))
    yield from motion
    yield from states_in_log(motion)
    yield from contact_forces(sources)
    yield from commands(sources)
    yield from steps(record)
    yield from alarms(record)
    yield from poses(record)
    yield from passes(record)
    yield from figures(record)
    yield from images(sources, form)


def _opened_and_closed(sources: RunSources) -> Iterator[TimedMessage]:
    head = sources.record.head
    simulated = " SIMULATED" if head.simulated else ""
    what = f"run {head.number} of {head.process}, part {head.serial}{simulated}"
    yield log(nanoseconds(head.started), "run", f"{what}: record opened")
    if head.ended is not None:
        level = Log.INFO if head.fault_number is None else Log.ERROR
        text = f"{what}: {head.result}" + (f", {head.fault}" if head.fault else "")
        yield log(nanoseconds(head.ended), "run", text, level)
    if sources.record.seal is None:
        sources.missing.append("end of the run: its record is still open")


def _head(record: RunRecord) -> dict[str, str]:
    """What identifies the run, its part and what it was made with."""
    head = record.head
    texts = {
        "number": head.number, "process": head.process, "serial": head.serial,
        "recipe": head.recipe_name, "recipe_sha256": head.recipe_hash,
        "cell_sha256": head.config_hash, "software": head.software, "mode": head.mode,
        "operator": head.operator, "SIMULATED": head.simulated,
        "started": head.started.isoformat(),
        "ended": "" if head.ended is None else head.ended.isoformat(),
        "result": head.result or "open",
        PART_VERDICT: part_verdict(record) or "open", "fault": head.fault or "",
        "seal": "" if record.seal is None else record.seal.hash,
    }  # fmt: skip
    calibrations = {f"calibration {kind}": one for kind, one in head.calibration_ids.items()}
    return {name: str(value) for name, value in (texts | calibrations).items()}
