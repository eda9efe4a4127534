"""What the store gives back: one run as frozen values."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Any

Six = tuple[float | None, ...]
"""x, y, z in mm, rx, ry, rz (or A, B, C of a pose) in degrees; None is unknown."""

PRODUCTION = "production"
"""Mode of the runs that make parts."""


class RunResult(StrEnum):
    """How a run ended."""

    GOOD = "good"
    BAD = "bad"
    STOPPED = "stopped"
    ABORTED = "aborted"
    INTERRUPTED = "interrupted"
    """The daemon ended without closing it; found at the next start."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """A measured pose."""

    time: datetime
    kind: str
    pose_mm_deg: Six
    sigma_mm_deg: Six
    residual_um: float | None
    """Rms over the holes."""
    frames: int
    detail: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Iteration:
    """One pass of the measure-compensate loop."""

    time: datetime
    iteration: int
    error_mm_deg: Six
    sigma_mm_deg: Six
    threshold_mm_deg: Six
    frames: int
    residual_um: float | None
    """Rms over the holes."""
    converged: bool
    correction_mm_deg: Six


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


@dataclass(frozen=True, slots=True)
class RunHead:
    """A run without its details."""

    number: int
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


@dataclass(frozen=True, slots=True)
class Seal:
    """The run's place in the hash chain."""

    number: int
    time: datetime
    content: str
    previous: str
    hash: str


@dataclass(frozen=True, slots=True)
class RunRecord:
    """Everything about a run."""

    head: RunHead
    measurements: tuple[Measurement, ...]
    iterations: tuple[Iteration, ...]
    mating: Mapping[str, Any] | None
    artefacts: tuple[Artefact, ...]
    alarms: tuple[Alarm, ...]
    gauges: tuple[Gauge, ...]
    """The newest per hole."""
    seal: Seal | None
    """None while the run is open."""
