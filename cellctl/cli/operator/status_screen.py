"""The status of the cell as a screen for operators."""

from datetime import datetime

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from cellctl.api.local.report import CalibrationReport, FaultReport, StatusReport

_COLOURS = {
    "ABORTED": "bold red",
    "ABORTING": "bold red",
    "STOPPED": "yellow",
    "HELD": "yellow",
    "EXECUTE": "bold green",
    "IDLE": "green",
    "COMPLETED": "green",
}
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
    step = report.step + (f", pass {report.iteration}" if report.iteration else "")
    rows = [
        ("cell", Text(report.cell + (" (simulated)" if report.simulated else ""))),
        ("state", state),
        ("mode", Text(report.mode.capitalize())),
        ("control", Text(_CONTROL[report.control])),
        ("step", Text(step or "–")),
        ("last run", Text(_last_run(report))),
        ("guard", _well(report.guard_trip and f"stop requested: {report.guard_trip}")),
        ("links", _links(report)),
    ]
    return [*rows, ("records", _well(report.records))] if report.records else rows


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
        f"{run.result or 'open'}; good parts {report.good_parts}"
    )


def _fault(fault: FaultReport, kind: str, colour: str) -> Text:
    text = Text(f"{kind} {fault.text}\n", style=colour)
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
    return f"{(now - item.made).days} d", f"{left} d"


def _well(problem: str) -> Text:
    return Text(problem, style="red") if problem else Text("good", style="green")
