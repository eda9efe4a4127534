"""Force curves as MCAP files, readable by common viewers.

A curve is encoded whole in memory when its contact is over and stored like any other file of the
run; a daemon that dies before that leaves no file. Small compressed chunks with a checksum each
let a damaged or shortened file be read up to the damage.
"""

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import IO, Self

import numpy as np
from mcap.writer import CompressionType, Writer

from cellctl.errors.records.store import RecordingUnreadable
from cellctl.force.contact.curve import ForceCurve
from cellctl.geometry.pose import MM, Array
from cellctl.records.entries import Artefact
from cellctl.records.files.mcap_reading import MEDIA_TYPE, read_mcap
from cellctl.records.files.unfinished import MOTION

_TOPIC = "/contact/force"
_FACTS = "facts"
_CHUNK_BYTES = 64 * 1024
"""A process that is killed loses one chunk at most. In a test the default of 1 MB lost up to 5400
samples, chunks of 64 KB none that had been flushed."""
_FIELDS = ("fx_n", "fy_n", "fz_n", "mx_n_m", "my_n_m", "mz_n_m")
_SCHEMA = {
    "title": "contact.Force",
    "description": "frame of the moved part, gravity removed, tared; travel along the approach",
    "type": "object",
    "properties": {name: {"type": "number"} for name in ("time_s", "travel_mm", *_FIELDS)},
}


@dataclass(frozen=True, slots=True)
class Recording:
    """A curve that was read from a file."""

    curve: ForceCurve
    facts: Mapping[str, str]
    complete: bool
    """False when the file was cut off; the curve then ends early."""


class CurveWriter:
    """Writes samples to a stream; a context, ended properly also on an exception."""

    def __init__(self, stream: IO[bytes], started: datetime, facts: Mapping[str, str]) -> None:
        """``started`` is the wall-clock time of ``time_s`` zero of this file."""
        self._stream = stream
        self._start_ns = int(started.timestamp() * 1e9)
        self._writer = Writer(stream, chunk_size=_CHUNK_BYTES, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library="cellctl")
        schema = json.dumps(_SCHEMA).encode()
        schema_id = self._writer.register_schema("contact.Force", "jsonschema", schema)
        self._channel = self._writer.register_channel(_TOPIC, "json", schema_id)
        self._writer.add_metadata(_FACTS, dict(facts))

    def add(self, time_s: float, travel_m: float, wrench: Array) -> None:
        """One sample; travel may be NaN."""
        values = {"time_s": round(time_s, 6)}
        # Left out when it is unknown, because JSON has no NaN; the reader fills it in again.
        if np.isfinite(travel_m):
            values["travel_mm"] = round(travel_m / MM, 5)
        # Four decimals are 0.1 mN, far below the noise of a sensor.
        values |= {name: round(float(v), 4) for name, v in zip(_FIELDS, wrench, strict=True)}
        time_ns = self._start_ns + int(time_s * 1e9)
        self._writer.add_message(self._channel, time_ns, json.dumps(values).encode(), time_ns)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._writer.finish()


def is_curve(artefact: Artefact) -> bool:
    """Whether a file of a run is a force curve, and not the recording of the whole run."""
    return artefact.media_type == MEDIA_TYPE and artefact.name != MOTION


def encode_curve(curve: ForceCurve, started: datetime, facts: Mapping[str, str]) -> bytes:
    """A finished recording of a whole curve; its time starts at zero."""
    stream = io.BytesIO()
    with CurveWriter(stream, started, facts) as writer:
        # From zero, because the monotonic clock of the guard means nothing outside of this run;
        # ``started`` says when that was.
        begin_s = curve.time_s[0] if len(curve.time_s) else 0.0
        samples = zip(curve.time_s - begin_s, curve.travel_m, curve.wrench, strict=True)
        for time_s, travel_m, wrench in samples:
            writer.add(float(time_s), float(travel_m), wrench)
    return stream.getvalue()


def read_recording(source: bytes | Path) -> Recording:
    """Read a recording as far as it goes; raises ``RecordingUnreadable`` when that is nowhere."""
    data = source if isinstance(source, bytes) else source.read_bytes()
    content = read_mcap(data)
    rows: list[list[float]] = []
    complete = content.complete
    for message in content.messages:
        row = _sample(message.values)
        if row is None:
            complete = False
            break
        rows.append(row)
    if content.messages and not rows:
        raise RecordingUnreadable("its first message is no sample of a force")
    table = np.array(rows).reshape(-1, 8)
    curve = ForceCurve(table[:, 0], table[:, 2:], table[:, 1] * MM)
    return Recording(curve, content.facts, complete)


def _sample(values: object) -> list[float] | None:
    """Time, travel and wrench of a message, NaN for what it lacks; None where it is no sample."""
    if not isinstance(values, dict):
        return None
    found = [values.get(name, np.nan) for name in ("time_s", "travel_mm", *_FIELDS)]
    # True and False would pass for numbers.
    if not all(isinstance(value, int | float) and not isinstance(value, bool) for value in found):
        return None
    try:
        return [float(value) for value in found]
    except OverflowError:
        return None
