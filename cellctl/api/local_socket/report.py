"""The status of the cell as `cellctl status` receives it."""

from datetime import datetime
from typing import Literal

from pydantic import BaseModel, ConfigDict


class StrictModel(BaseModel):
    """Refuses fields that it does not know, as the messages do."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class FaultReport(StrictModel):
    """A fault, latched in the machine or still on the list of alarms."""

    number: int
    text: str
    """Text of the fault, with the facts of this occurrence where they are known."""
    cause: str
    remedy: str
    since: datetime | None = None
    """When an alarm came first and a latched fault last, UTC; None for a fault whose alarm was
    acknowledged."""


class AxisReport(StrictModel):
    """One component of a pose error or of a wrench; None where there is none."""

    axis: str
    unit: str
    value: float | None
    limit: float | None = None


class ForceReport(StrictModel):
    """What a force sensor feels now, the payload's weight removed."""

    sensor: str
    age_s: float | None
    """Age of the newest sample; None before the first."""
    stale: bool = False
    """The newest sample is too old to say what is felt now, and no wrench is shown."""
    compensated: bool
    """Otherwise the weight is still in it, and no wrench is shown."""
    limit_n: float | None
    presses_n: float | None = None
    """Force with which an arm may press in Stopped or Aborted; None where none does."""
    wrench: tuple[AxisReport, ...]


class CalibrationReport(StrictModel):
    """One calibration; without dates where none can be read."""

    kind: str
    made: datetime | None = None
    valid_until: datetime | None = None
    problem: str = ""
    """Why production cannot use it; empty when it can."""
    identity: str = ""
    """Identity by which runs name it."""


class RunReport(StrictModel):
    """The newest run of the store."""

    number: int
    serial: str
    recipe: str
    mode: str
    started: datetime
    result: str
    """As recorded; empty while it is open. A dry run that came to its end is recorded as bad."""
    ended_as: str = ""
    """The result in the words of lists: ``done, no part`` for such a dry run."""


class StatusReport(StrictModel):
    """A snapshot of the cell."""

    cell: str
    simulated: bool
    state: str
    state_requested: str
    mode: str
    control: Literal["line", "shared"]
    """Line: the PLC alone may do what moves the cell; see docs/operating.md."""
    line_alive: bool
    connected: bool
    """All devices were connected and the daemon does not end."""
    ready: bool
    """Idle, and Start would be taken."""
    hold_requested: bool
    safe_point_ahead: bool = True
    """A Hold takes effect before the run ends, as far as is known; in a mating that comes to
    nothing a further try may bring another safe point."""
    step: str
    iteration: int
    errors: tuple[AxisReport, ...]
    """Of the pose, from target to part, as measured last, with their thresholds."""
    forces: tuple[ForceReport, ...]
    permitted: dict[str, str]
    """By name of the command: empty if it would be taken now, else why it would be refused."""
    faults: tuple[FaultReport, ...]
    """Latched ones, the first is what stopped the cell."""
    alarms: tuple[FaultReport, ...]
    """Not yet acknowledged, the oldest first."""
    guard_trip: str
    """The trip that the guard has latched; empty when there is none."""
    guard_touch: str = ""
    """The touch that a step looks for, at which the guard has stopped the robot; empty without."""
    links: dict[str, str]
    """Robots and guard by name; what is wrong with each, empty when it is well."""
    calibrations: tuple[CalibrationReport, ...]
    result: str
    """Result of the present or last job: ``none`` while it is open, else the ``run_result``, or
    ``done, no part`` after a dry run that came to its end."""
    last_run: RunReport | None
    good_parts: int
    records: str
    """The fault of the run store; empty when it is well."""
    data_dir: str
    """Folder of the run store."""
