"""The cell at this moment, as the daemon pushes it to whoever shows it to people.

Two messages, each one JSON object. ``snapshot`` is what changes by itself, built from memory alone.
``description`` is what files and the store say; it is built in threads, and sent when it changes.
No number is NaN: a value that is missing is null.
"""

import math
import secrets
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from cellctl.api.local_socket.device_links import device_links
from cellctl.cell.devices import Cell
from cellctl.clock import now_s
from cellctl.command.arbiter import CommandArbiter
from cellctl.command.latest import TakenCommand
from cellctl.command.permitted import permitted
from cellctl.command.validator import line_in_control
from cellctl.errors import CellError
from cellctl.fault_catalogue import known_fault
from cellctl.force.gravity.gravity_compensation import GRAVITY_M_S2
from cellctl.guard.client import GuardClient
from cellctl.guard.health import is_present
from cellctl.packml.state import State
from cellctl.runtime.alarms import ActiveAlarm
from cellctl.runtime.cell_status import CellStatus
from cellctl.runtime.unit import UnitController

Object = dict[str, Any]
SLOW_PERIOD_S = 0.5
"""How often what costs more to ask is asked: links of devices, and what is permitted."""
PRESSES_N = 10.0
"""Force from which on an arm may press: above what the zero of a sensor drifts by, and below every
force of a mating."""
_BEGIN_BITS = 48
"""Browsers count exactly up to 53 bits."""
_UNTARED_SHARE = 0.02
"""What a compensation leaves of a weight away from the attitude for which it was identified: twice
the cross-talk of 1 % that data sheets state."""
_STOPPED = frozenset({State.STOPPED, State.ABORTED})
_POSE = (("x", "mm"), ("y", "mm"), ("z", "mm"), ("rx", "°"), ("ry", "°"), ("rz", "°"))
_WRENCH = (("Fx", "N"), ("Fy", "N"), ("Fz", "N"), ("Mx", "N·m"), ("My", "N·m"), ("Mz", "N·m"))


class LiveView:
    """Builds snapshots. Belongs to the event loop, changes nothing and does not raise."""

    def __init__(
        self,
        cell: Cell,
        unit: UnitController,
        arbiter: CommandArbiter,
        daemon: Callable[[], Object],
    ) -> None:
        """``daemon`` gives whether the daemon itself is well, from memory as all the rest."""
        self._daemon = daemon
        self._cell = cell
        self._unit = unit
        self._arbiter = arbiter
        self._slow: Object = {}
        self._slow_s = -math.inf
        self._decided_on: tuple[object, ...] = ()
        self.decision = secrets.randbits(_BEGIN_BITS)
        """Counts what a person decides upon: state, mode, faults, links. A command says which
        count its person has seen. Begins anywhere, so that none of an earlier daemon fits: its
        commands come again, and nobody here remembers their keys."""

    def look(self) -> int:
        """Count a change of what a person decides upon; the count by now."""
        machine = self._unit.machine
        faults = tuple(map(id, machine.faults))
        seen = (
            machine.state,
            machine.mode,
            faults,
            self._arbiter.line_alive,
            self._unit.live,
        )
        if seen != self._decided_on:
            self._decided_on = seen
            self.decision += 1
            self._slow_s = -math.inf  # what is permitted has changed as well
        return self.decision

    def permitted(self) -> tuple[str, ...]:
        """Names of the commands that would be taken now."""
        machine, alive = self._unit.machine, self._arbiter.line_alive
        codes = permitted(machine, self._unit.factory, line_alive=alive)
        return tuple(name for name, code in codes.items() if not code)

    def procedures(self) -> tuple[tuple[int, str], ...]:
        """Numbers and names of this cell's procedures."""
        return tuple((one.number, one.label) for one in self._unit.factory.procedures.values())

    def snapshot(self, status: CellStatus) -> Object:
        """The message ``snapshot``; ``status`` is what the line is shown at the same moment."""
        decision, time_s = self.look(), now_s()
        if time_s - self._slow_s >= SLOW_PERIOD_S:
            self._slow_s, self._slow = time_s, self._slowly()
        machine, alive = self._unit.machine, self._arbiter.line_alive
        progress = self._unit.board.current
        return {
            "kind": "snapshot",
            "mono_s": time_s,
            "decision": decision,
            "cell": self._cell.config.name,
            "simulated": status.simulation,
            "state": status.state.name,
            "state_requested": status.state_requested.name,
            "state_s": status.state_time_s,
            "mode": status.mode.name,
            "control": "line" if line_in_control(machine.mode, line_alive=alive) else "shared",
            "line_alive": alive,
            "connected": self._unit.live,
            "ready": status.ready,
            "hold_requested": status.hold_requested,
            "safe_point_ahead": status.safe_point_ahead,
            "stop_not_confirmed": status.stop_not_confirmed,
            "step": {"number": status.step, "label": status.step_label, "text": progress.message},
            "pass": status.iteration,
            "run": {
                "number": status.run_number,
                "serial": status.serial,
                "recipe": status.recipe_active,
                "result": status.run_result.name.lower(),
                "good_parts": status.cycle_counter,
            },
            "errors": _limited(_POSE, status.error_mm_deg, progress.error_limits_mm_deg),
            "forces": [self._force(name, time_s, status) for name in self._cell.guards],
            "faults": [_fault(fault) for fault in machine.faults],
            "alarms": [_alarm(alarm) for alarm in self._unit.alarms.active],
            "last_command": _taken(self._arbiter.latest),
            **self._slow,
        }

    def _slowly(self) -> Object:
        codes = permitted(
            self._unit.machine, self._unit.factory, line_alive=self._arbiter.line_alive
        )
        return {
            "daemon": self._daemon(),
            "guards": {name: _guard(guard) for name, guard in self._cell.guards.items()},
            "permitted": {
                name: {"code": int(code), "reason": code.text if code else ""}
                for name, code in codes.items()
            },
            "links": device_links(self._cell, self._unit.machine.faults),
        }

    def _force(self, name: str, time_s: float, status: CellStatus) -> Object:
        guard = self._cell.guards[name]
        sample = guard.newest()
        # A wrench with the part's weight still in it is no contact force: better none than that.
        weighed = sample is not None and guard.gravity_compensated
        stale = sample is not None and not is_present(sample, time_s)
        newest: list[float] = sample.wrench.tolist() if sample and weighed else [math.nan] * 6
        # A zero that a Reset has taken in contact hides what it was pressed with. The warning that
        # an arm may press rests on the newest sample, however old: silence does not end a contact.
        felt = [*newest[:2], newest[2] + (guard.hidden_axial_n or 0.0)]
        # In the sensor's own axes the signs are not those of the part; the magnitude is the same.
        # The force that the zero hides is added: without it the wrench of an arm that a Reset is
        # lifting off would read as a pull.
        told = guard.in_part_frame and not stale
        shown = [*felt, *newest[3:]] if told else [math.nan] * 6
        stopped = "" if guard.trip is None else str(guard.trip)
        awaited = self._unit.view.is_awaited_touch(name)
        return {
            "sensor": name,
            "age_s": None if sample is None else max(0.0, time_s - sample.receive_time_s),
            "stale": stale,
            "compensated": weighed,
            "limit_n": number(status.force_limit_n),
            "presses_n": _pressing_n(status.state, felt, self._least_n(name)),
            "trip": "" if awaited else stopped,
            "touch": stopped if awaited else "",
            "wrench": _limited(_WRENCH, shown),
            "peaks": [number(value) for value in status.force_peaks],
        }

    def _least_n(self, name: str) -> float:
        """Force from which on the arm of a sensor may press.

        In the sensor's own axes nothing was tared since the last free move, and after a start of
        the guard nothing at all: what is felt then is as well what the compensation leaves of the
        load.
        """
        config = self._cell.config
        load = config.robots[config.force_sensors[name].mounted_on].load
        guard = self._cell.guards[name]
        if load is None or (guard.in_part_frame and guard.hidden_axial_n is not None):
            return PRESSES_N
        return max(PRESSES_N, _UNTARED_SHARE * load.mass_kg * GRAVITY_M_S2)


def _guard(guard: GuardClient) -> Object:
    health = guard.health()
    return {
        "late_wakeups": health.late_wakeups,
        "flange_age_s": number(health.flange_age_s),
    }


def _pressing_n(state: State, force: Sequence[float], least_n: float) -> float | None:
    """What an arm that was stopped presses with, N; None where it moves or hardly presses.

    Only where nothing moves by itself, but a Reset may: there somebody has to know before.
    """
    force_n = math.hypot(*force)
    return force_n if state in _STOPPED and force_n >= least_n else None


def number(value: float) -> float | None:
    """JSON knows neither NaN nor infinity."""
    return value if math.isfinite(value) else None


def _limited(
    axes: Iterable[tuple[str, str]], values: Iterable[float], limits: Iterable[float] = ()
) -> list[Object]:
    limits = tuple(limits) or (math.nan,) * 6
    return [
        {"axis": axis, "unit": unit, "value": number(value), "limit": number(limit)}
        for (axis, unit), value, limit in zip(axes, values, limits, strict=True)
    ]


def _fault(error: CellError) -> Object:
    return {
        "number": error.number,
        "text": str(error),
        "cause": error.cause,
        "remedy": error.remedy,
        "reaction": error.reaction.name.lower(),
    }


def _alarm(alarm: ActiveAlarm) -> Object:
    # The alarm may come from an older store, or from a process that is not installed any more.
    known = known_fault(alarm.number) or CellError
    return {
        "number": alarm.number,
        "text": alarm.text,
        "cause": known.cause,
        "remedy": known.remedy,
        "reaction": known.reaction.name.lower(),
        "since": alarm.since.isoformat(timespec="milliseconds"),
        "run": alarm.run,
        "times": alarm.times,
        "newest": (alarm.newest or alarm.since).isoformat(timespec="milliseconds"),
    }


def _taken(command: TakenCommand | None) -> Object | None:
    if command is None:
        return None
    time = command.time.isoformat(timespec="milliseconds")
    return {"who": command.who, "command": command.name, "time": time}
