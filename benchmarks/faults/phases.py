"""The phases in which something moves or is in contact, and how to get into each of them.

Whether the cell is there is asked of the line's registers, of the fake cell's arms, and of its true
contact force.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from benchmarks.faults.bench import ARMS, OVER, Bench
from benchmarks.faults.line import Shown
from fakes.demo.processes.deck_calibration import PROCEDURES

PRODUCTION, MAINTENANCE = 1, 2
TOUCHED_N = 8.0
"""True contact force. What the sensor reads is no sign of a touch: before the tare, and while the
arm speeds up, drift, hysteresis and inertia make as much of it."""
FREE_N = 1.0
"""Bound of the contact force where there must be no contact at all."""
LIMIT_N = 50.0
"""The recipe's ``limit_force_n``."""
FOREIGN_BODY = {"x_mm": 0.0, "y_mm": 0.0, "height_mm": 0.2}
"""Met in the slow travel: the mating ends with F522 and backs off."""
UNDER_WAY_MM, CREEPING_MM = 3.0, 0.03
"""How far an arm has come when the fault is injected; the latter at the speeds of a contact."""
REACH_S = 150.0
RESET_OVER = frozenset({"Idle", "Aborted"})

Reach = Callable[[Bench], str]
"""Brings the cell into the phase; the arm that moves or is in contact. Raises ``NotReached``."""


@dataclass(frozen=True, slots=True)
class Phase:
    """One column of the matrix."""

    key: str
    title: str
    reach: Reach
    peak_bound_n: float = FREE_N
    sensor_moves: bool = True
    """The robot with the force sensor moves or is in contact here, or does so next."""
    images: bool = True
    """Images are taken here or later in the same job."""
    line_stops_at_once: bool = False
    """A lost line stops here at once instead of before the next move."""
    has_record: bool = True
    fresh: bool = False
    """Whether the phase needs a cell in which nothing has moved yet."""
    starts: bool = False
    """Nothing is under way: Start is given when the fault is there."""


def start_run(bench: Bench) -> None:
    """A production run is asked for and taken."""
    bench.command("Start", mode=PRODUCTION, recipe=1, serial="FAULT.1")


def _arm_under_way(
    bench: Bench,
    what: str,
    travelled_mm: float,
    step: int | None = None,
    arms: Sequence[str] = ARMS,
) -> str:
    """The arm that moves, in a step if one is given."""
    found: list[str] = []

    def there(shown: Shown) -> bool:
        arm = bench.moving_arm(travelled_mm, arms) if step in {None, shown.step} else None
        found.extend([arm] if arm else [])
        return bool(found)

    ends = RESET_OVER if step is None else OVER
    bench.until(what, there, timeout_s=REACH_S, ends=ends)
    return found[0]


def _idle(bench: Bench) -> str:
    bench.to_idle(PRODUCTION)
    return "main"


def _starting(bench: Bench) -> str:
    bench.to_idle(PRODUCTION)
    start_run(bench)
    return _arm_under_way(bench, "heads on their way", UNDER_WAY_MM)


def _step_begins(step: int, bench: Bench) -> str:
    bench.to_idle(PRODUCTION)
    start_run(bench)
    bench.until(f"step {step}", lambda shown: shown.step == step, timeout_s=REACH_S)
    return "main"


def _step_moves(step: int, bench: Bench) -> str:
    bench.to_idle(PRODUCTION)
    start_run(bench)
    return _arm_under_way(bench, f"motion in step {step}", UNDER_WAY_MM, step)


def _until_touching(bench: Bench, timeout_s: float) -> None:
    def touches(_shown: object) -> bool:
        return float(bench.truth()["contact_force_n"]) > TOUCHED_N

    bench.until("contact", touches, timeout_s=timeout_s)


def _contact(bench: Bench) -> str:
    _step_begins(50, bench)
    _until_touching(bench, REACH_S)
    return "main"


def _back_off(bench: Bench) -> str:
    _step_begins(50, bench)
    bench.inject("world", "foreign_body", **FOREIGN_BODY)

    def rises(_shown: object) -> bool:
        motions = bench.watched()["motions"]["main"]
        return bool(motions) and motions[-1]["ended_s"] is None and motions[-1]["rise_mm"] > 0.01

    bench.until("back-off", rises, timeout_s=REACH_S)
    return "main"


def _lift_off(bench: Bench) -> str:
    """Lift off after an abort in contact, with the arm pressing on the frame."""
    _contact(bench)
    bench.command("Abort")
    bench.until("Aborted", lambda shown: shown.state == "Aborted")
    bench.command("Clear")
    bench.plc.done(30)
    bench.control.request("watch_begin")
    bench.command("Reset", mode=PRODUCTION)
    return _arm_under_way(bench, "lift-off", CREEPING_MM)


def _reset_home(bench: Bench) -> str:
    """Go home after a stop on the way to the measuring pose: no contact, and a long way."""
    _step_moves(20, bench)
    bench.command("Stop")
    bench.plc.done(30)
    bench.control.request("watch_begin")
    bench.command("Reset", mode=PRODUCTION)
    return _arm_under_way(bench, "way home", UNDER_WAY_MM)


def _procedure(number: int, arms: Sequence[str], bench: Bench) -> str:
    bench.to_idle(MAINTENANCE)
    procedure = next(one for one in PROCEDURES if one.number == number)
    procedure.prepare(bench.control, bench.own.cell)
    bench.command("Start", mode=MAINTENANCE, recipe=number, serial="FAULT.1")
    return _arm_under_way(bench, f"motion in procedure {number}", UNDER_WAY_MM, number, arms)


def _procedure_contact(bench: Bench) -> str:
    bench.to_idle(MAINTENANCE)
    bench.command("Start", mode=MAINTENANCE, recipe=108, serial="FAULT.1")
    _until_touching(bench, 2 * REACH_S)
    return "main"


def _in_procedure(number: int, title: str, *, sensor_moves: bool, images: bool) -> Phase:
    return Phase(
        f"procedure-{number}",
        f"procedure {number}, {title}, an arm moves",
        partial(_procedure, number, ARMS[:1] if sensor_moves else ARMS),
        sensor_moves=sensor_moves,
        images=images,
    )


PHASES = (
    Phase("start", "Idle, and Start is given", _idle, starts=True),
    Phase("starting", "Starting, the heads move", _starting, fresh=True),
    Phase("measure-frame", "step 10, measure frame, nothing moves", partial(_step_begins, 10)),
    Phase("measure-deck", "step 20, measure deck, the arm moves", partial(_step_moves, 20)),
    Phase("pre-assembly", "step 30, pre-assembly, the arm moves", partial(_step_moves, 30)),
    Phase("correct-pose", "step 40, correct pose, images are taken", partial(_step_begins, 40)),
    Phase(
        "way-down",
        "step 50, mate, the arm moves down",
        partial(_step_moves, 50),
        LIMIT_N,
        line_stops_at_once=True,
    ),
    Phase("contact", "step 50, mate, in contact", _contact, LIMIT_N, line_stops_at_once=True),
    Phase("verify", "step 60, verify, pressed on the frame", partial(_step_begins, 60), LIMIT_N),
    Phase(
        "back-off",
        "back-off after a mating that met a foreign body",
        _back_off,
        LIMIT_N,
        images=False,
        line_stops_at_once=True,
    ),
    Phase(
        "lift-off",
        "Resetting, lift-off after an abort in contact",
        _lift_off,
        LIMIT_N,
        images=False,
        line_stops_at_once=True,
        has_record=False,
    ),
    Phase(
        "reset-home",
        "Resetting, the arm drives home",
        _reset_home,
        images=False,
        line_stops_at_once=True,
        has_record=False,
    ),
    _in_procedure(101, "calibrate head 1", sensor_moves=False, images=True),
    _in_procedure(102, "calibrate head 2", sensor_moves=False, images=True),
    _in_procedure(103, "calibrate base frame", sensor_moves=True, images=False),
    _in_procedure(104, "calibrate board 1", sensor_moves=False, images=True),
    _in_procedure(105, "calibrate board 2", sensor_moves=False, images=True),
    _in_procedure(106, "identify payload", sensor_moves=True, images=False),
    _in_procedure(107, "measure stop latency", sensor_moves=True, images=False),
    Phase(
        "procedure-108",
        "procedure 108, measure contact stiffness, in contact",
        _procedure_contact,
        LIMIT_N,
        images=False,
        line_stops_at_once=True,
    ),
)
