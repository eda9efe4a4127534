"""What ended a run early: the fault with the step it came in, its cause and its remedy."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from cellctl.fault_catalogue import known_fault
from cellctl.records.entered.said_by import was_obeyed
from cellctl.records.entries import Alarm, AuditEntry, RunRecord, RunResult
from cellctl.records.report.text import MISSING, when

_BY_COMMAND = {
    RunResult.STOPPED: "stop",
    RunResult.ABORTED: "abort",
    RunResult.BAD: "complete",
}


@dataclass(frozen=True, slots=True)
class FaultBox:
    """The fault of a run, or the command that ended it."""

    text: str
    step: str
    """The phase in which it came."""
    cause: str
    remedy: str


def fault_box(record: RunRecord, audit: Sequence[AuditEntry]) -> FaultBox | None:
    """What ended the run early; None when nothing did.

    ``audit`` are the entries of the time of the run: they say who ended a run that has no fault.
    """
    head = record.head
    if head.fault or head.fault_number:
        cause, remedy = cause_and_remedy(head.fault_number or 0)
        text = head.fault or f"F{head.fault_number:03d}"
        return FaultBox(text, _last_step(record), cause, remedy)
    if head.result is None or head.result == RunResult.INTERRUPTED:
        return _cut_off(record)
    command = _BY_COMMAND.get(RunResult(head.result))
    if command is None:
        return None
    obeyed = (one for one in reversed(audit) if one.action == command and was_obeyed(one))
    given = next(obeyed, None)
    if given is None and head.result == RunResult.BAD:
        # It came to its own end, and its part is bad by what was measured.
        return None
    who = "it is not recorded by whom" if given is None else f"by {given.actor}, {when(given.time)}"
    return FaultBox(f"Ended by the command {command}, {who}", _last_step(record), MISSING, MISSING)


def _cut_off(record: RunRecord) -> FaultBox:
    """A run that no daemon closed while it was made."""
    if record.head.result is None:
        text = "Not closed: this run is at work, its daemon was killed, or its disk takes no record"
    else:
        text = "Interrupted: the daemon ended, or its disk took nothing more, before this run was "
        text += "closed; what follows is unknown"
    return FaultBox(
        text,
        _last_step(record),
        "The daemon was killed, the PC went down, or the disk was full or failing; that the run "
        "was not closed was written at the next start.",
        "Nothing below says that the part is good: values were taken before the interruption. "
        "Look at part and arm, and make the run again.",
    )


def cause_and_remedy(number: int) -> tuple[str, str]:
    """Cause and remedy from the fault catalogue; dashes for a number that is not in it."""
    fault = known_fault(number)
    return (MISSING, MISSING) if fault is None else (fault.cause, fault.remedy)


@dataclass(frozen=True, slots=True)
class AlarmLine:
    """An alarm with what the catalogue says of its number."""

    alarm: Alarm
    step: str
    cause: str
    remedy: str


def alarm_lines(record: RunRecord) -> tuple[AlarmLine, ...]:
    """Every alarm of the run."""
    return tuple(
        AlarmLine(alarm, _step_at(record, alarm.time), *cause_and_remedy(alarm.number))
        for alarm in record.alarms
    )


def _step_at(record: RunRecord, time: datetime) -> str:
    begun = [phase for phase in record.phases if phase.began <= time]
    return f"{begun[-1].number}, {begun[-1].label}" if begun else "before the first step"


def _last_step(record: RunRecord) -> str:
    if not record.phases:
        return "before the first step"
    last = record.phases[-1]
    return f"{last.number}, {last.label}"
