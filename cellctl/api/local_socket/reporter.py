"""Compiles the status of the cell for operators, in words; changes nothing."""

import asyncio
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

from cellctl.api.local_socket.live_view import LiveView
from cellctl.api.local_socket.report import (
    AxisReport,
    CalibrationReport,
    FaultReport,
    ForceReport,
    RunReport,
    StatusReport,
)
from cellctl.calibration.store.inventory import inventory
from cellctl.cell.devices import Cell
from cellctl.cell.robot_reports import listen
from cellctl.clock import utc_now
from cellctl.command.arbiter import CommandArbiter
from cellctl.command.validator import line_in_control
from cellctl.errors import CellError
from cellctl.errors.local import MessageMalformed
from cellctl.fault_catalogue import known_fault
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.outcome import outcome
from cellctl.records.store import RunStore
from cellctl.runtime.alarms import ActiveAlarm
from cellctl.runtime.guide import Guide
from cellctl.runtime.unit import UnitController


class Reporter:
    """Reads machine, devices and records; files and store in threads of their own."""

    def __init__(
        self,
        cell: Cell,
        unit: UnitController,
        arbiter: CommandArbiter,
        store: AsyncRunStore,
        view: LiveView,
    ) -> None:
        self._cell = cell
        self._unit = unit
        self._arbiter = arbiter
        self._store = store
        self._view = view

    async def robot(self, name: str, seconds: float) -> dict[str, dict[str, Any]]:
        """What a robot says for so long; raises ``MessageMalformed`` and what its state raises."""
        robot = self._cell.robots.get(name)
        if robot is None:
            raise MessageMalformed(
                f"no robot {name!r}; this cell has {', '.join(self._cell.robots)}"
            )
        return (await listen(robot, seconds)).as_json()

    async def report(self) -> StatusReport:
        """Everything at this moment. What cannot be read is reported as such, not raised."""
        # First what needs waiting, then everything else in one turn of the loop: state, step and
        # faults of one report belong to one moment.
        calibrations = await asyncio.to_thread(self._calibrations)
        last_run, records = await self._from_store()
        unit, machine = self._unit, self._unit.machine
        shown = unit.view.snapshot(unit.jobs.shown, unit.jobs.shown_result, unit.parts)
        live = self._view.snapshot(shown)
        stops: dict[bool, list[str]] = {True: [], False: []}
        for name, guard in self._cell.guards.items():
            if (trip := guard.trip) is not None:
                said = f"{trip.reason.value}: {trip.detail}"
                stops[unit.view.is_awaited_touch(name)].append(said)
        alive, active = self._arbiter.line_alive, unit.alarms.active
        return StatusReport(
            cell=self._cell.config.name,
            simulated=self._cell.config.simulated,
            state=machine.state.name,
            state_requested=machine.state_requested.name,
            mode=machine.mode.name,
            control="line" if line_in_control(machine.mode, line_alive=alive) else "shared",
            line_alive=alive,
            connected=unit.live,
            ready=shown.ready,
            hold_requested=shown.hold_requested,
            safe_point_ahead=shown.safe_point_ahead,
            step=shown.step_label,
            iteration=shown.iteration,
            errors=_axes(live["errors"]),
            forces=tuple(_force(force) for force in live["forces"]),
            permitted={name: one["reason"] for name, one in live["permitted"].items()},
            faults=tuple(_fault(fault, active) for fault in machine.faults),
            alarms=tuple(_alarm(alarm) for alarm in active),
            guard_trip="; ".join(stops[False]),
            guard_touch="; ".join(stops[True]),
            links=live["links"],
            calibrations=calibrations,
            result=_job_result(unit.jobs.result.name.lower(), last_run),
            last_run=last_run,
            good_parts=unit.parts,
            records=records,
            data_dir=str(self._store.path),
        )

    async def description(self) -> dict[str, Any]:
        """What pages show besides the live values: calibrations, lists to choose from, records."""
        calibrations = await asyncio.to_thread(self._calibrations)
        last_run, records = await self._from_store()
        procedures = self._unit.factory.procedures.values()
        return {
            "calibrations": [item.model_dump(mode="json") for item in calibrations],
            "recipes": [{"number": r.id, "name": r.name} for r in self._cell.config.recipes],
            "procedures": [
                {"number": one.number, "name": one.label, **_guide(one.guide)} for one in procedures
            ],
            "last_run": None if last_run is None else last_run.model_dump(mode="json"),
            "records": records,
        }

    async def _from_store(self) -> tuple[RunReport | None, str]:
        """The newest run, and what is wrong with the store."""
        try:
            heads = await self._store.do(RunStore.runs, 1)
        except CellError as error:
            # A store that fails must not keep the operator from seeing the state and the faults.
            return None, str(error)
        runs = [
            RunReport(
                number=head.number,
                serial=head.serial,
                recipe=head.recipe_name,
                mode=head.mode,
                started=head.started,
                result=head.result or "",
                ended_as=outcome(head.mode, head.result),
            )
            for head in heads
        ]
        return next(iter(runs), None), _refusal(self._store)

    def _calibrations(self) -> tuple[CalibrationReport, ...]:
        return tuple(
            CalibrationReport(
                kind=entry.name,
                made=entry.made,
                valid_until=entry.valid_until,
                problem=entry.problem,
                identity=entry.identity,
            )
            for entry in inventory(self._unit.calibrations, utc_now())
        )


def _job_result(result: str, last_run: RunReport | None) -> str:
    """A dry run has made no part, which the line's register has as a bad one; nothing is wrong."""
    same = last_run is not None and last_run.result == result
    return last_run.ended_as if last_run is not None and same else result


def _guide(guide: Guide) -> dict[str, list[str]]:
    return {part: list(lines) for part, lines in asdict(guide).items()}


def _fault(error: CellError, alarms: Iterable[ActiveAlarm]) -> FaultReport:
    # Every fault that is latched has come as an alarm, whose last occurrence it is.
    times = (alarm.newest or alarm.since for alarm in alarms if alarm.number == error.number)
    return FaultReport(
        number=error.number,
        text=str(error),
        cause=error.cause,
        remedy=error.remedy,
        since=next(times, None),
    )


def _alarm(alarm: ActiveAlarm) -> FaultReport:
    # The alarm may come from an older store or from a process that is not installed any longer.
    known = known_fault(alarm.number) or CellError
    return FaultReport(
        number=alarm.number,
        text=alarm.text,
        cause=known.cause,
        remedy=known.remedy,
        since=alarm.since,
    )


def _axes(entries: Iterable[Mapping[str, Any]]) -> tuple[AxisReport, ...]:
    return tuple(AxisReport(**entry) for entry in entries)


def _force(force: Mapping[str, Any]) -> ForceReport:
    return ForceReport(
        sensor=force["sensor"],
        age_s=force["age_s"],
        stale=force["stale"],
        compensated=force["compensated"],
        limit_n=force["limit_n"],
        presses_n=force["presses_n"],
        wrench=_axes(force["wrench"]),
    )


def _refusal(store: AsyncRunStore) -> str:
    """Why no run is taken, and what ends that; empty when one is."""
    if store.fault is None:
        return str(store.refusal or "")
    # What was wrong with the disk then may have been mended since.
    return (
        f"a write has failed ({store.fault}): nothing is recorded any more, and no Start is taken, "
        "until the disk has room and is sound and the daemon is started again"
    )
