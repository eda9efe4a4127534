"""A recorded insertion from a file, CSV or MCAP, with everything that is wrong refused by name."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.cell.contact_motion.ticks import MotionKind
from cellctl.files.hand_written import hand_written
from cellctl.force.contact.recorded_units import impossible_sampling
from cellctl.geometry.pose import Array
from cellctl.processes.peg_in_hole.faults import PegCurveInvalid
from cellctl.processes.peg_in_hole.offline.columns import (
    DEPTH,
    FORCES,
    MOMENTS,
    TIME,
    Column,
    X,
    Y,
    columns_of,
)
from cellctl.processes.peg_in_hole.record.tick_log import KIND, MOTION
from cellctl.records.files.mcap_reading import RecordedMessage, read_mcap

_MCAP_MAGIC = b"\x89MCAP"
_FEWEST = 20
"""A file with fewer samples is no curve of an insertion."""

Motion = tuple[int, MotionKind]


@dataclass(frozen=True, slots=True, eq=False)
class PegCurve:
    """Samples in frame A: z into the hole from the touched face, forces of the hole on the peg."""

    samples: tuple[ContactSample, ...]
    motions: tuple[Motion, ...] | None
    """Number and kind of the motion of each sample; None where the file does not say."""
    columns: Mapping[str, str] = field(default_factory=dict)
    """Names of the file's columns by quantity, for what is wrong with them."""

    @property
    def interval_s(self) -> float:
        """Usual time between two samples."""
        return float(np.median(np.diff([sample.time_s for sample in self.samples])))


def read_curve(path: Path, *, force_on_hole: bool = False) -> PegCurve:
    """Raises ``PegCurveInvalid`` or ``RecordingUnreadable``.

    ``force_on_hole``: the forces of the file are those of the peg on the hole.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise PegCurveInvalid(f"{path}: {error.strerror or error}") from error
    return parse_curve(data, force_on_hole=force_on_hole)


def parse_curve(data: bytes, *, force_on_hole: bool = False) -> PegCurve:
    """The same of the content of a file."""
    rows = _mcap_rows(data) if data.startswith(_MCAP_MAGIC) else _csv_rows(data)
    if len(rows) < _FEWEST:
        raise PegCurveInvalid(f"{len(rows)} samples, at least {_FEWEST} needed")
    columns = columns_of(rows[0])
    time_s = _values(rows, columns[TIME])
    _require_rising(time_s, columns[TIME].name)
    tip_m = np.stack([_values(rows, columns[name]) for name in (X, Y, DEPTH)], axis=1)
    if why := impossible_sampling(time_s, columns[TIME].name):
        raise PegCurveInvalid(why)
    sign = -1.0 if force_on_hole else 1.0
    force_n = sign * np.stack([_values(rows, columns[name]) for name in FORCES], axis=1)
    moment_n_m = sign * np.stack(
        [
            _values(rows, columns[name]) if name in columns else np.full(len(rows), np.nan)
            for name in MOMENTS
        ],
        axis=1,
    )
    samples = tuple(
        ContactSample(float(at_s), tip, np.zeros(3), force, moment, 0.0)
        for at_s, tip, force, moment in zip(time_s, tip_m, force_n, moment_n_m, strict=True)
    )
    names = {quantity: column.name for quantity, column in columns.items()}
    return PegCurve(samples, _motions(rows), names)


def _csv_rows(data: bytes) -> list[dict[str, str]]:
    try:
        text = hand_written(data)
    except UnicodeDecodeError as error:
        raise PegCurveInvalid(f"is neither MCAP nor text: {error}") from error
    head = text.partition("\n")[0]
    delimiter = max(",;\t", key=head.count)
    rows: list[dict[str, str]] = []
    reader = csv.reader(io.StringIO(text), delimiter=delimiter)
    try:
        names = [name.strip() for name in next(reader, [])]
        columns_of(names)
        for row in reader:
            if not row:
                continue  # an empty line, which many programs write last
            if len(row) != len(names):
                raise PegCurveInvalid(
                    f"line {reader.line_num}: {len(row)} values for {len(names)} columns"
                )
            rows.append(dict(zip(names, row, strict=True)))
    except csv.Error as error:
        raise PegCurveInvalid(f"line {reader.line_num}: {error}") from error
    return rows


def _mcap_rows(data: bytes) -> list[Mapping[str, object]]:
    content = read_mcap(data)
    if not content.complete:
        raise PegCurveInvalid(f"is cut off or damaged after {len(content.messages)} messages")
    by_topic: dict[str, list[RecordedMessage]] = {}
    for message in content.messages:
        by_topic.setdefault(message.topic, []).append(message)
    reasons = {}
    for topic, messages in by_topic.items():
        if not all(isinstance(message.values, dict) for message in messages):
            reasons[topic] = "no messages with named values"
            continue
        try:
            columns_of(messages[0].values)
        except PegCurveInvalid as fault:
            reasons[topic] = fault.detail
        else:
            return [message.values for message in messages]
    raise PegCurveInvalid("; ".join(f"topic {name}: {why}" for name, why in reasons.items()))


def _values(rows: Sequence[Mapping[str, object]], column: Column) -> Array:
    values = np.empty(len(rows))
    for index, row in enumerate(rows):
        written = row.get(column.name)
        try:
            # True and False would pass for numbers, and a list would not.
            value = float(written) if isinstance(written, str | int | float) else np.nan
        except (ValueError, OverflowError):
            value = np.nan
        if not np.isfinite(value) or isinstance(written, bool):
            raise PegCurveInvalid(f"sample {index + 1}: {column.name} is {written!r}")
        values[index] = value
    scaled = values * column.factor
    if not np.isfinite(scaled).all():
        raise PegCurveInvalid(f"{column.name} has numbers that are no measurement")
    return np.asarray(scaled)


def _require_rising(time_s: Array, name: str) -> None:
    back = np.flatnonzero(np.diff(time_s) < 0)
    if back.size:
        raise PegCurveInvalid(f"sample {back[0] + 2}: {name} falls")


def _motions(rows: Sequence[Mapping[str, object]]) -> tuple[Motion, ...] | None:
    named = [name for name in (MOTION, KIND) if name in rows[0]]
    if not named:
        return None
    if len(named) == 1:
        raise PegCurveInvalid(f"column {named[0]} without its companion: {MOTION} and {KIND}")
    found: list[Motion] = []
    for index, row in enumerate(rows):
        try:
            found.append((int(str(row.get(MOTION))), MotionKind(str(row.get(KIND)))))
        except ValueError as error:
            kinds = ", ".join(MotionKind)
            raise PegCurveInvalid(f"sample {index + 1}: {error}; kinds are {kinds}") from error
    return tuple(found)
