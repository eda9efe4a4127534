"""The values that the store takes and gives back; all of them are frozen.

Fields have the names of the columns in ``schema.py``. ``time`` is UTC; ``phase`` is the ``id`` of a
``Phase`` and is filled in by the store with the phase that the run is in.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any

from cellctl.clock import utc_now
from cellctl.records.seals import Seal

Six = tuple[float | None, ...]
"""x, y, z in mm, rx, ry, rz (or A, B, C of a pose) in degrees; None is unknown."""
Matrix = tuple[tuple[float | None, ...], ...]
"""6 x 6 covariance in the order of ``Six``, in mm and degrees."""

PRODUCTION, MAINTENANCE, DRY_RUN = "production", "maintenance", "dry run"
"""Modes of the runs that make parts; of procedures, whose process it is too, as a procedure may
belong to several; of runs that end before the first contact, and make none."""


class RunResult(StrEnum):
    """How a run ended."""

    GOOD = "good"
    BAD = "bad"
    STOPPED = "stopped"
    ABORTED = "aborted"
    INTERRUPTED = "interrupted"
    """The daemon ended without closing it; found at the next start."""


class Verdict(StrEnum):
    """Whether a figure is within its limits."""

    PASS = "pass"
    FAIL = "fail"


class PoseOrigin(StrEnum):
    """Where the knowledge of a pose comes from."""

    MEASURED = "measured"
    """The pose was measured, by cameras or by touch."""
    COMMANDED = "commanded"
    """The target that a robot was given."""
    REPORTED = "reported"
    """The pose was reported by the robot, from its own encoders."""


@dataclass(frozen=True, slots=True)
class Phase:
    """A stretch of a run, usually one step of its process."""

    id: int
    number: int
    """Number of the step, as the line sees it in the step register."""
    label: str
    began: datetime
    ended: datetime | None
    """End of the phase; None while it lasts, and for ever when the daemon died in it."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A named figure; make one with ``cellctl.records.figures.figure``."""

    key: str
    """Stable name for evaluation, nested with dots: ``approach.speed``."""
    label: str
    """Words for people."""
    value: float | None
    """The value; None when it is unknown."""
    unit: str
    lower: float | None = None
    upper: float | None = None
    verdict: Verdict | None = None
    """None when the figure has no limit, PASS within its limits, FAIL beyond them or when
    unknown."""
    time: datetime = field(default_factory=utc_now)
    phase: int | None = None


@dataclass(frozen=True, slots=True)
class RecordedPose:
    """A pose ``parent_T_child``."""

    key: str
    origin: PoseOrigin
    parent: str
    child: str
    pose_mm_deg: Six
    """X, Y, Z in mm, A, B, C in degrees."""
    sigma_mm_deg: Six | None = None
    """Standard deviations of x, y, z, rx, ry, rz in the axes of the parent."""
    covariance_mm_deg: Matrix | None = None
    """Covariance in the convention of ``cellctl.geometry.uncertain``. None for poses that are not
    measured, and in runs of schema 1, which kept the standard deviations alone."""
    residual_um: float | None = None
    """Rms of the features that were fitted."""
    frames: int | None = None
    detail: Mapping[str, Any] = field(default_factory=dict)
    time: datetime = field(default_factory=utc_now)
    phase: int | None = None


@dataclass(frozen=True, slots=True)
class PassComponent:
    """One component of the error that a loop brings down."""

    name: str
    unit: str
    value: float | None
    sigma: float | None
    limit: float | None
    """Converged at or below this magnitude."""
    correction: float | None = None
    """What was corrected after this pass; None when nothing was."""


@dataclass(frozen=True, slots=True)
class LoopPass:
    """One pass of a loop that measures and corrects."""

    loop: str
    number: int
    components: tuple[PassComponent, ...]
    converged: bool
    residual_um: float | None = None
    """Rms of the features that were fitted."""
    frames: int | None = None
    time: datetime = field(default_factory=utc_now)
    phase: int | None = None

    @property
    def worst_ratio(self) -> float:
        """The greatest error as a share of its limit, where there is one; NaN for unknown ones."""
        limited = [(c.value, c.limit) for c in self.components if c.limit]
        shares = [math.nan if value is None else abs(value) / limit for value, limit in limited]
        return max(shares, key=lambda share: (math.isnan(share), share), default=0.0)


@dataclass(frozen=True, slots=True)
class Document:
    """What a process knows of a run besides figures and poses, as plain data."""

    key: str
    content: Mapping[str, Any]
    time: datetime = field(default_factory=utc_now)
    phase: int | None = None


RunDetail = Figure | RecordedPose | LoopPass | Document
"""What a run takes while it is open."""


@dataclass(frozen=True, slots=True)
class Artefact:
    """A file of the run."""

    time: datetime
    name: str
    sha256: str
    size: int
    media_type: str


@dataclass(frozen=True, slots=True)
class Alarm:
    """A fault or warning."""

    id: int
    run: int | None
    time: datetime
    number: int
    text: str
    acknowledged: datetime | None
    acknowledged_by: str | None


@dataclass(frozen=True, slots=True)
class Gauge:
    """The largest plug gauge that passed a pin hole."""

    time: datetime
    hole: str
    diameter_mm: float
    source: str
    """Name of the person who measured."""
    gauge_id: str | None = None
    """Id of the plug gauge itself; None in stores of schema 1 and 2, empty where nobody named
    one."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """A calibration as it was when it was stored."""

    id: str
    kind: str
    serial_number: str
    software: str
    made: datetime
    valid_until: datetime
    record: Mapping[str, Any]
    invalidated: datetime | None = None
    invalidated_reason: str | None = None


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """Who did what."""

    time: datetime
    actor: str
    action: str
    detail: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class RunHead:
    """A run without its details."""

    number: int
    process: str
    """Name of the process (entry point ``cellctl.process``) that made the run."""
    serial: str
    recipe_id: int
    recipe_name: str
    recipe_hash: str
    mode: str
    operator: str
    software: str
    config_hash: str
    simulated: bool
    calibration_ids: Mapping[str, str]
    started: datetime
    ended: datetime | None
    result: str | None
    """A ``RunResult``, None while it is open."""
    fault_number: int | None
    fault: str | None
    record_schema: int
    """Schema of the store that wrote it."""


@dataclass(frozen=True, slots=True)
class RunRecord:
    """Everything about a run, each kind in the order in which it was written."""

    head: RunHead
    phases: tuple[Phase, ...]
    figures: tuple[Figure, ...]
    poses: tuple[RecordedPose, ...]
    passes: tuple[LoopPass, ...]
    documents: tuple[Document, ...]
    artefacts: tuple[Artefact, ...]
    alarms: tuple[Alarm, ...]
    gauges: tuple[Gauge, ...]
    """The newest per hole: it counts."""
    gauge_history: tuple[Gauge, ...]
    """All gauges, the oldest first."""
    seal: Seal | None
    """Seal of the closed run; None while it is open."""

    @property
    def measurements(self) -> tuple[RecordedPose, ...]:
        """The measured poses alone."""
        return tuple(pose for pose in self.poses if pose.origin is PoseOrigin.MEASURED)

    @property
    def newest_figures(self) -> Mapping[str, Figure]:
        """The last figure of each key: a further attempt replaces what an earlier one found."""
        return {entry.key: entry for entry in self.figures}

    @property
    def beyond_limits(self) -> tuple[Figure, ...]:
        """Figures that count and are not within their limits."""
        newest = self.newest_figures.values()
        return tuple(entry for entry in newest if entry.verdict is Verdict.FAIL)

    def value(self, key: str) -> float | None:
        """The last value of a figure; None when it is unknown or was never recorded."""
        found = self.newest_figures.get(key)
        return None if found is None else found.value

    def document(self, key: str) -> Mapping[str, Any]:
        """All documents of a key as one, empty for none; of equal names the latest one counts."""
        merged: dict[str, Any] = {}
        for entry in self.documents:
            if entry.key == key:
                merged |= entry.content
        return merged
