"""The status of the cell as a screen for operators."""

from datetime import datetime

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from cellctl.api.local_socket.report import (
    AxisReport,
    CalibrationReport,
    FaultReport,
    ForceReport,
    StatusReport,
)
from cellctl.cli.operator.no_end import without_end
from cellctl.errors import CellError
from cellctl.errors.force import GuardDied, GuardRefused
from cellctl.records.entries import RunResult
from cellctl.records.outcome import outcome

_COLOURS = {
    "ABORTED": "bold red",
    "ABORTING": "bold red",
    "STOPPED": "yellow",
    "HELD": "yellow",
    "EXECUTE": "bold green",
    "IDLE": "green",
    "COMPLETED": "green",
}
_NEXT = {
    "STOPPED": "`cellctl reset`: robots are released, and one that stands in the station lifts off",
    "COMPLETED": "fasten a joined part as its process says, and open the gripper; then "
    "`cellctl reset`: it lifts off and clears the station",
    "HELD": "`cellctl unhold` measures anew and goes on; `cellctl stop` ends the run",
}
NO_SAFE_POINT = (
    "no safe point is left before the end of the run, unless this step has to be tried again; "
    "`cellctl stop` ends it at once"
)
_NEXT_WITHOUT_PART = (
    "this run joined no good part. What hangs free: leave its gripper closed. What stands in its "
    "place: do with it as its process says. Then `cellctl reset`"
)
_NEXT_AFTER_PROCEDURE = (
    "do what the guide of the procedure asks for at its end, and see that nothing hangs in an "
    "open gripper; then `cellctl reset`"
)
_NEXT_IN_IDLE = {
    "PRODUCTION": "`cellctl start --serial SERIAL`; before a procedure `cellctl mode maintenance`",
    "MAINTENANCE": "`cellctl procedure NUMBER`; before a part `cellctl mode production`",
    "MANUAL": "`cellctl mode production` or `maintenance`: in Manual nothing is started",
}
_NO_RUN = frozenset({"IDLE", "STOPPED", "ABORTED", "COMPLETED", "RESETTING", "CLEARING"})
"""States in which what was measured is of a run that has ended."""
_GUARDED = "force_sensors."
"""Links of force sensors are those of their guards."""
_OF_GUARD = frozenset({GuardDied.number, GuardRefused.number})
_BEGINS = {"PRODUCTION": "start", "MAINTENANCE": "procedure"}
_CONTROL = {
    "line": "line PLC; here only Stop, Abort, Hold, Clear and alarms",
    "shared": "terminal and line PLC",
}


def screen(report: StatusReport, now: datetime) -> RenderableType:
    """Everything in at most a screen; ``now`` in UTC, for the ages."""
    parts: list[RenderableType] = [_head(report)]
    parts += [_fault(fault, "fault", "red") for fault in report.faults]
    latched = {fault.number for fault in report.faults}
    # A latched fault is on the list of alarms, too. Shown once, it does not push others off the
    # screen.
    parts += [_fault(a, "alarm", "yellow") for a in report.alarms if a.number not in latched]
    return Group(*parts, _calibrations(report, now))


def last_seen(report: StatusReport, seen: datetime, away: CellError) -> RenderableType:
    """What is shown in place of the screen while the daemon does not answer; nothing in it is of
    now."""
    text = Text(f"{away}\n", style="bold red")
    text.append(f"remedy: {away.remedy}\n", style="default")
    last = f"{report.state.capitalize()}, mode {report.mode.capitalize()}, {_step(report)}"
    text.append(f"last seen at {seen:%H:%M:%S} UTC: {last}", style="dim")
    return text


def _head(report: StatusReport) -> Table:
    table = Table.grid(padding=(0, 2))
    for name, value in _rows(report):
        table.add_row(Text(name, style="dim"), value)
    return table


def _rows(report: StatusReport) -> list[tuple[str, Text]]:
    state = Text(report.state.capitalize(), style=_COLOURS.get(report.state, "cyan"))
    if report.state != report.state_requested:
        state.append(f", on its way to {report.state_requested.capitalize()}")
    if report.ready:
        state.append(", ready to start")
    rows = [
        ("cell", Text(report.cell + (" (simulated)" if report.simulated else ""))),
        ("state", state),
        ("mode", Text(report.mode.capitalize())),
        ("control", Text(_CONTROL[report.control])),
        ("step", Text(_step(report))),
        *(("pressing", Text(text, style="bold red")) for text in pressing(report)),
        ("next", Text(_next(report))),
        ("permitted", Text(", ".join(n for n, why in report.permitted.items() if not why) or "–")),
        *_measured(report),
        ("last run", Text(_last_run(report))),
        ("guard", _guard(report)),
        ("links", _links(report)),
    ]
    return [*rows, ("records", _well(report.records))] if report.records else rows


def pressing(report: StatusReport) -> tuple[str, ...]:
    """For each sensor whose arm may press: the force, and what has to be done before Reset.

    The sensor alone cannot tell a contact from the weight of a payload that is known to some
    newtons, or from braking: nobody may be told to open a gripper from which a part hangs.
    """
    return tuple(
        f"{force.presses_n:.1f} N at {force.sensor}; just after a stop, braking counts too. Look "
        "at the arm before `cellctl reset`, which lifts off. A part that rests on something: "
        "fasten it and take it out of the gripper, or see that it is loose. One that hangs free: "
        "leave the gripper closed"
        for force in report.forces
        if force.presses_n is not None
    )


def _guard(report: StatusReport) -> Text:
    # A guard that does not run has no trip, and is not good for that.
    problems = [text for name, text in report.links.items() if name.startswith(_GUARDED) and text]
    latched = [fault.text for fault in report.faults if fault.number in _OF_GUARD]
    problems += [text for text in latched if text not in problems]
    if report.guard_trip:
        problems.insert(0, f"stop requested: {report.guard_trip}")
    if problems or not report.guard_touch:
        return _well("; ".join(problems))
    return Text(f"good; stopped at the touch that the step looks for: {report.guard_touch}")


def _step(report: StatusReport) -> str:
    if not report.step:
        return "–"
    return report.step + (f", pass {report.iteration}" if report.iteration else "")


def hold_is_late(report: StatusReport) -> bool:
    """Whether a Hold was asked for that nothing obeys before the end of the run."""
    return report.hold_requested and not report.safe_point_ahead


def _next(report: StatusReport) -> str:
    """What an operator does now, in words."""
    if report.state != report.state_requested:
        late = hold_is_late(report)
        return f"wait; the Hold comes too late: {NO_SAFE_POINT}" if late else "wait"
    if report.state == "ABORTED":
        cause = "remove the cause of the fault" if report.faults else "look why it was aborted"
        return f"{cause}, then `cellctl clear`"
    if report.state == "IDLE":
        refused = report.permitted.get(_BEGINS.get(report.mode, ""), "")
        if refused and report.records:
            refused += "; `records` below says what is to be done"
        return f"Start is refused: {refused}" if refused else _NEXT_IN_IDLE[report.mode]
    if (report.state, report.mode) == ("COMPLETED", "MAINTENANCE"):
        # Nothing was joined: whoever opened the gripper now might drop the part that was weighed.
        return _NEXT_AFTER_PROCEDURE
    joined = report.last_run is not None and report.last_run.result == RunResult.GOOD
    if report.state == "COMPLETED" and not joined:
        # After a dry run, or a run that Complete has ended, the part hangs free over its place.
        return _NEXT_WITHOUT_PART
    hold = "`cellctl hold` pauses at the next safe point"
    if not report.safe_point_ahead:
        hold = f"a Hold would come too late: {NO_SAFE_POINT}"
    return _NEXT.get(report.state, f"wait; {hold}")


def _measured(report: StatusReport) -> list[tuple[str, Text]]:
    """Errors of the pose against their thresholds, and what the force sensors feel."""
    rows = []
    ended = report.state in _NO_RUN
    if any(axis.value is not None for axis in report.errors):
        errors = Text(", ").join(_axis(axis) for axis in report.errors)
        rows.append(("errors", Text(_of_run(report), style="dim") + errors if ended else errors))
    for force in report.forces:
        name = f"at {force.sensor}" if len(report.forces) > 1 else "force"
        rows.append((name, _force(force, limited=not ended)))
    return rows


def _of_run(report: StatusReport) -> str:
    """Says of figures that nothing of them is of now."""
    run = "the last run" if report.last_run is None else f"run {report.last_run.number}"
    return f"of {run}, which has ended, part against target: "


def _axis(axis: AxisReport) -> Text:
    if axis.value is None:
        return Text(f"{axis.axis} –")
    limit = f" of ±{axis.limit:g}" if axis.limit is not None else ""
    beyond = axis.limit is not None and abs(axis.value) > axis.limit
    colour = "red" if beyond else "default"
    return Text(f"{axis.axis} {axis.value:.4f}{limit} {axis.unit}", style=colour)


def _force(force: ForceReport, *, limited: bool) -> Text:
    """``limited``: a run is under way, whose limit counts."""
    if force.age_s is None:
        return Text("no sample", style="red")
    if force.stale:
        return Text(f"not known: the newest sample is {force.age_s:.0f} s old", style="red")
    if not force.compensated:
        return Text("the payload's weight is not removed yet", style="yellow")
    felt = ", ".join(
        f"{one.axis} {one.value:.1f} {one.unit}" for one in force.wrench if one.value is not None
    )
    if not felt:
        # After a free move: the signs of the sensor's axes say nothing of the part.
        felt = "in the axes of the sensor; shown in those of the part from the next tare on"
    if limited and force.limit_n is not None:
        felt += f"; limit {force.limit_n:g} N"
    return Text(felt)


def _links(report: StatusReport) -> Text:
    broken = [f"{name}: {problem}" for name, problem in report.links.items() if problem]
    if not report.connected:
        broken.insert(0, "not all devices are connected")
    text = _well("; ".join(broken))
    text.append(f"; line PLC {'alive' if report.line_alive else 'not there'}", style="default")
    return text


def _last_run(report: StatusReport) -> str:
    run = report.last_run
    if run is None:
        return "–"
    return (
        f"{run.number}, {run.serial}, {run.recipe}, {run.mode}, {run.started:%Y-%m-%d %H:%M} UTC: "
        f"{outcome(run.mode, run.result or None)}; good parts {report.good_parts}"
    )


def with_time(fault: FaultReport) -> str:
    """The text of a fault or an alarm with the time since which it is there."""
    since = f", since {fault.since:%Y-%m-%d %H:%M:%S} UTC" if fault.since is not None else ""
    return f"{fault.text}{since}"


def _fault(fault: FaultReport, kind: str, colour: str) -> Text:
    text = Text(f"{kind} {with_time(fault)}\n", style=colour)
    text.append(f"  cause:  {fault.cause}\n", style="default")
    text.append(f"  remedy: {fault.remedy}", style="default")
    return text


def _calibrations(report: StatusReport, now: datetime) -> Table:
    table = Table("calibration", "age", "valid for", "", box=None, header_style="dim")
    for item in report.calibrations:
        table.add_row(item.kind.replace("_", " "), *_dates(item, now), _well(item.problem))
    return table


def _dates(item: CalibrationReport, now: datetime) -> tuple[str, str]:
    if item.made is None or item.valid_until is None:
        return "–", "–"
    # Whole days, rounded down: a calibration lasts at least as long as the screen says.
    left = max(0, (item.valid_until - now).days)
    valid_for = "no end" if without_end(item.valid_until, now) else f"{left} d"
    return f"{(now - item.made).days} d", valid_for


def _well(problem: str) -> Text:
    return Text(problem, style="red") if problem else Text("good", style="green")
