"""A snapshot of the cell for whoever watches it: line, terminal, page."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import State

NO_VALUE = float("nan")


@dataclass(frozen=True, slots=True)
class ShownRefusal:
    """A command or a mode that was refused."""

    age_s: float
    mode: Mode
    """Mode of the unit when it refused."""
    state: State
    """State of the unit when it refused."""
    request: int
    """Number of the command, or 0x100 plus the number of the mode that was asked for."""
    code: RejectCode


@dataclass(frozen=True, slots=True)
class CellStatus:
    """A snapshot in the line's units (mm, degrees, N, N·m, h); NaN is a value that is missing."""

    state: State = State.ABORTED
    state_requested: State = State.ABORTED
    mode: Mode = Mode.PRODUCTION
    step: int = 0
    step_label: str = ""
    iteration: int = 0
    ready: bool = False
    error: bool = False
    warning: bool = False
    calibration_ok: bool = False
    simulation: bool = False
    manual: bool = False
    force_guard_tripped: bool = False
    hold_requested: bool = False
    safe_point_ahead: bool = True
    """Of a run under way: a Hold takes effect before its end, as far as is known."""
    stop_not_confirmed: bool = False
    """A robot did not confirm its last stop and may still move."""
    alarms: tuple[int, ...] = ()
    """Numbers of all active alarms, the oldest first."""
    first_out_alarm: int = 0
    recipe_active: int = 0
    cycle_counter: int = 0
    run_number: int = 0
    run_result: Result = Result.NONE
    validity_h: Mapping[str, float] = field(default_factory=dict)
    """Hours of validity left, by name of the register. A register to which no calibration of the
    cell belongs reads 0."""
    validity_least_h: float = math.inf
    """Hours until the first of the required calibrations ends; infinite where the cell requires
    none."""
    error_mm_deg: tuple[float, ...] = (NO_VALUE,) * 6
    """x, y, z in mm, rx, ry, rz in degrees."""
    force_peaks: tuple[float, ...] = (NO_VALUE,) * 6
    """Fx, Fy, Fz in N, Mx, My, Mz in N·m."""
    force_z_n: float = NO_VALUE
    force_limit_n: float = NO_VALUE
    serial: str = ""
    mode_time_s: float = 0.0
    """Seconds since the mode changed last: ModeTimeCurrent."""
    state_time_s: float = 0.0
    """Seconds since the state changed last: StateTimeCurrent."""
    refusals: tuple[ShownRefusal, ...] = ()
    """The last eight at most, the newest first."""
