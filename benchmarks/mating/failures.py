"""Failures injected into a mating, the fault that each must end in, and its force."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress
from tests.rigs.mating.cell import MatingCell, SensorFault
from tests.rigs.mating.trial import Hook, Trial, run_trial

STIFFNESS_N_M = 3e6
STOP_LATENCY_MS = 250.0


@dataclass(frozen=True, slots=True)
class Failure:
    """One way to fail."""

    name: str
    outcomes: tuple[str, ...]
    """Any of these is right."""
    prepare: Callable[[MatingCell], None] | None = None
    hook: Hook | None = None
    settings: dict[str, Any] = field(default_factory=dict)
    bounded: bool = True
    """True where physics allows to stay below 50 N."""
    note: str = ""


def run_failure(index: int) -> Trial:
    """Run the failure with this number."""
    failure = FAILURES[index]
    trial = Trial(failure.name, 1000 + index, STIFFNESS_N_M, STOP_LATENCY_MS)
    return run_trial(trial, failure.hook, failure.prepare, **failure.settings)


def _in_phase(phase: MatingPhase, action: Callable[[MatingCell], None]) -> Hook:
    """Do something once, when a phase begins."""
    done: list[int] = []

    def hook(cell: MatingCell, progress: MatingProgress) -> None:
        if progress.phase is phase and id(cell) not in done:
            done.append(id(cell))
            action(cell)

    return hook


def _sensor(kind: str, phase: MatingPhase) -> Hook:
    def spoil(cell: MatingCell) -> None:
        cell.sensor_fault = SensorFault(kind, cell.world.time_s + 0.05)

    return _in_phase(phase, spoil)


def _world_fault(name: str, **parameters: float) -> Callable[[MatingCell], None]:
    def prepare(cell: MatingCell) -> None:
        cell.world.faults.inject(name, count=None, **parameters)
        cell.world.rebuild()

    return prepare


def _ignore_stops(count: int | None) -> Callable[[MatingCell], None]:
    return lambda cell: cell.faults.inject("ignore_stop", count=count)


def _lose_link(cell: MatingCell) -> None:
    cell.robot.lose_link(cell.world.time_s)


_SLOW, _CREEP = MatingPhase.SLOW, MatingPhase.CREEP

FAILURES: tuple[Failure, ...] = (
    Failure("sensor silent, guarded travel", ("F501",), hook=_sensor("silent", _SLOW)),
    Failure("sensor silent, creep", ("F501",), hook=_sensor("silent", _CREEP)),
    Failure("sensor frozen, guarded travel", ("F504",), hook=_sensor("frozen", _SLOW)),
    Failure("sensor frozen, creep", ("F504",), hook=_sensor("frozen", _CREEP)),
    Failure("sensor at half its rate", ("F505",), hook=_sensor("slow", _SLOW)),
    Failure("sensor saturated", ("F502",), hook=_sensor("saturated", _SLOW)),
    Failure("NaN-like bytes", ("F503",), hook=_sensor("damaged", _SLOW)),
    Failure(
        "robot link lost, guarded travel",
        ("F202",),
        hook=_in_phase(_SLOW, _lose_link),
        note="no back-off without a link; the controller stops by itself",
    ),
    Failure("robot link lost, creep", ("F202",), hook=_in_phase(_CREEP, _lose_link)),
    Failure("stop request ignored once", ("seated",), prepare=_ignore_stops(1)),
    Failure(
        "every stop request ignored",
        ("F304", "F302", "F306", "F512"),
        prepare=_ignore_stops(None),
        note="bounded by the length of a single move; the guard withholds its heartbeat",
    ),
    Failure(
        "contact 0.25 mm early",
        ("F522",),
        prepare=_world_fault("foreign_body", x_mm=0.0, y_mm=0.0, height_mm=0.25),
    ),
    Failure(
        "contact 3 mm early",
        ("F522",),
        prepare=_world_fault("foreign_body", x_mm=0.0, y_mm=0.0, height_mm=3.0),
        bounded=False,
        note="in the fast travel: about k·v·T = 5 mm/s · 0.25 s · k above the limit of 20 N",
    ),
    Failure(
        "contact 3 mm early, fast travel at 0.08 mm/s",
        ("F522",),
        prepare=_world_fault("foreign_body", x_mm=0.0, y_mm=0.0, height_mm=3.0),
        settings={"fast_speed_m_s": 8e-5, "fast_limit_n": 15.0},
        note="the same with no fast travel at all: what 50 N would cost in time",
    ),
    Failure("contact late: no frame", ("F523",), prepare=_world_fault("no_frame")),
    Failure(
        "chamfer catch 0.2 mm above the seat",
        ("false seat", "F525"),
        prepare=_world_fault("pin_catch", x_mm=0.0, y_mm=0.0, height_mm=0.2, slope_deg=20.0),
        settings={"least_window_m": 3e-4},
    ),
    Failure(
        "chamfer catch 6 mm above the seat",
        ("F522",),
        prepare=_world_fault("pin_catch", x_mm=-480.0, y_mm=-180.0, height_mm=6.0),
        bounded=False,
        note="in the fast travel, as above",
    ),
)
