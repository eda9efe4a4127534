"""The faults: how each is begun and ended, what it demands, and where it makes no sense and why."""

import signal
from collections.abc import Callable
from dataclasses import dataclass

from benchmarks.faults.bench import Bench
from benchmarks.faults.observation import Effect
from benchmarks.faults.phases import Phase

Begin = Callable[[Bench, str], None]
"""Gets the arm that moves."""
End = Callable[[Bench], None]

STOP_S = 2.5
NO_SENSOR_ARM = "the arm that moves here carries no force sensor"
NO_IMAGES = "no image is taken here, nor later in this job"
IMAGES_TAKEN = (
    "the images are taken as the verification begins, perhaps before the fault; a camera that "
    "fails just before it is tried in contact"
)
LINE_MAY_FINISH = (
    "the verification, in which nothing moves, is finished without a line (docs/operating.md)"
)
NO_CLOCK = "no move and no stop reads the time of day; it is asked for at Start"
NO_START_MOTION = "nothing is under way that a stop could end"


@dataclass(frozen=True, slots=True)
class Fault:
    """One row of the matrix."""

    key: str
    title: str
    begin: Begin
    effect: Effect = Effect.AT_ONCE
    bound_s: float = STOP_S
    """Longest time until all motion has ended: detection, stop latency, 0.8 s of a joint ramp."""
    patience_s: float = 60.0
    """Longest time until the line has seen where it ends."""
    silent_s: float = 0.0
    """The line sees nothing for so long; then the fault goes over by itself (``resume``)."""
    noticed_s: float = 0.0
    """Nobody can know of it earlier."""
    resume: End | None = None
    line_silent: bool = False
    """The line sees nothing until the daemon is started again."""
    may_restart: bool = False
    """Whether the daemon has to be started again afterwards; its fault says so then."""
    reason_not: Callable[[Phase], str | None] = lambda _phase: None
    """Why there is nothing to see in a phase."""


def _robot(name: str, **parameters: float) -> Begin:
    return lambda bench, arm: bench.inject(arm, name, **parameters)


def _sensor(name: str, value: float = 1.0) -> Begin:
    return lambda bench, _arm: bench.inject("force", name, value=value)


def _cameras(name: str, value: float = 1.0) -> Begin:
    def begin(bench: Bench, _arm: str) -> None:
        for head in ("head_1", "head_2"):
            bench.inject(head, name, value=value)

    return begin


def _signal(whom: str, number: signal.Signals) -> Begin:
    return lambda bench, _arm: bench.signal(whom, number)


def _overheard_abort(bench: Bench, arm: str) -> None:
    bench.inject(arm, "ignore_stop")
    bench.command("Abort")


def _line_dead(bench: Bench, _arm: str) -> None:
    bench.plc.fall_silent()


def _without_sensor(phase: Phase) -> str | None:
    return None if phase.sensor_moves else NO_SENSOR_ARM


def _without_images(phase: Phase) -> str | None:
    return None if phase.images else NO_IMAGES


def _without_new_images(phase: Phase) -> str | None:
    return IMAGES_TAKEN if phase.key == "verify" else _without_images(phase)


def _line_finishes(phase: Phase) -> str | None:
    return LINE_MAY_FINISH if phase.key == "verify" else None


def _only_at_start(phase: Phase) -> str | None:
    return None if phase.starts else NO_CLOCK


def _nothing_to_stop(phase: Phase) -> str | None:
    return NO_START_MOTION if phase.starts else None


def _camera(key: str, title: str, name: str, value: float = 1.0) -> Fault:
    return Fault(
        f"camera-{key}",
        f"both heads {title}",
        _cameras(name, value),
        Effect.AT_NEXT_USE,
        patience_s=240.0,  # the cell file's reply time-out is 60 s: the fake head renders first
        reason_not=_without_new_images,
    )


def _force(key: str, title: str, name: str, value: float = 1.0) -> Fault:
    begin = _sensor(name, value)
    return Fault(f"sensor-{key}", f"force sensor {title}", begin, reason_not=_without_sensor)


FAULTS = (
    Fault(
        "stop-ignored",
        "robot overhears every stop; Abort",
        _overheard_abort,
        bound_s=8.0,
        reason_not=_nothing_to_stop,
    ),
    Fault("link-cut", "robot's links cut", _robot("cut")),
    Fault("half-open", "robot's links half open", _robot("half_open"), bound_s=4.0),
    Fault("late", "robot's records 1 s late", _robot("late", delay_s=1.0), bound_s=4.0),
    Fault("corrupt", "a robot's record corrupt", _robot("corrupt", count=1)),
    Fault(
        "robot-clock-back",
        "robot's clock set back by 100 s",
        _robot("clock_jump", jump_ms=-100_000.0),
    ),
    Fault("emergency-stop", "emergency stop at the robot", _robot("emergency_stop")),
    Fault("mode-change", "robot's key to manual", _robot("manual_mode")),
    Fault("drives-off", "robot's drives off", _robot("drives_off")),
    _force("silent", "silent", "silent"),
    _force("frozen", "frozen", "frozen"),
    _force("jumping", "jumping by half its scale", "jump_every", 20),
    _force("saturated", "saturated", "saturated"),
    _force("half-open", "half open", "half_open"),
    _force("late", "1 s late", "late_s", 1.0),
    _force("corrupt", "corrupt", "corrupt_every", 1),
    _camera("silent", "silent", "silent"),
    _camera("stale", "stale: the last pair again and again", "frozen"),
    _camera("black", "black", "black"),
    _camera("half-open", "half open", "half_open"),
    _camera("corrupt", "with a corrupt image", "corrupt_payload"),
    Fault(
        "line-dead",
        "line PLC dead",
        _line_dead,
        Effect.MOVE_ENDS,
        bound_s=60.0,
        patience_s=120.0,
        noticed_s=3.5,  # ``heartbeat_timeout_s`` of the cell file, and a beat
        reason_not=_line_finishes,
    ),
    Fault(
        "daemon-killed",
        "daemon killed",
        _signal("daemon", signal.SIGKILL),
        line_silent=True,
        may_restart=True,
    ),
    Fault(
        "daemon-suspended",
        "daemon suspended for 5 s",
        _signal("daemon", signal.SIGSTOP),
        bound_s=4.0,
        silent_s=5.0,
        resume=lambda bench: bench.signal("daemon", signal.SIGCONT),
    ),
    Fault("guard-killed", "guard killed", _signal("guard", signal.SIGKILL), bound_s=4.0),
    Fault("guard-suspended", "guard suspended", _signal("guard", signal.SIGSTOP), bound_s=5.0),
    Fault(
        "workers-killed",
        "both vision workers killed",
        _signal("workers", signal.SIGKILL),
        Effect.AT_NEXT_USE,
        patience_s=120.0,
        reason_not=_without_images,
    ),
    Fault(
        "workers-suspended",
        "both vision workers suspended",
        _signal("workers", signal.SIGSTOP),
        Effect.AT_NEXT_USE,
        patience_s=240.0,
        reason_not=_without_images,
    ),
    Fault(
        "disk-full",
        "disk full",
        lambda bench, _arm: bench.fill_disk(),
        Effect.AT_NEXT_USE,
        may_restart=True,
        patience_s=180.0,
    ),
    Fault(
        "clock-back",
        "the PC's clock set back by a day",
        lambda bench, _arm: bench.set_clock(-86_400.0),
        Effect.AT_NEXT_USE,
        reason_not=_only_at_start,
    ),
)


def demanded(fault: Fault, phase: Phase) -> tuple[Effect, float]:
    """Effect and bound of a fault in a phase."""
    if fault.effect is Effect.MOVE_ENDS and phase.line_stops_at_once:
        return Effect.AT_ONCE, fault.noticed_s + STOP_S
    if fault.effect is Effect.AT_ONCE and phase.starts:
        return Effect.AT_NEXT_USE, fault.bound_s  # other arms may begin to move
    return fault.effect, fault.bound_s
