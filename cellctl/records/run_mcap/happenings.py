"""What happened: commands, steps, alarms, and all of it as a log."""

import json
from collections.abc import Iterator
from datetime import datetime

from foxglove_schemas_protobuf.Log_pb2 import Log

from cellctl.records.entries import RunRecord
from cellctl.records.run_mcap.message import (
    JsonValues,
    RecordedJson,
    TimedMessage,
    nanoseconds,
    stamp,
)
from cellctl.records.run_mcap.sources import RunSources

LOG = "/log"
_STATE = "/unit/state"


def commands(sources: RunSources) -> Iterator[TimedMessage]:
    """What the line and people commanded, from the start of the run on."""
    for entry in sources.audit:
        values = {"action": entry.action, "who": entry.actor, "detail": dict(entry.detail)}
        time_ns = nanoseconds(entry.time)
        yield TimedMessage(time_ns, "/commands", JsonValues("cellctl.Command", values))
        yield log(time_ns, "commands", f"{entry.action} by {entry.actor}")


def steps(record: RunRecord) -> Iterator[TimedMessage]:
    """Begin and end of each step; of one in which the daemon died only the begin."""
    for phase in record.phases:
        for event, time in (("begins", phase.began), ("ends", phase.ended)):
            if time is not None:
                values = {"number": phase.number, "label": phase.label, "event": event}
                time_ns = nanoseconds(time)
                yield TimedMessage(time_ns, "/steps", JsonValues("cellctl.Step", values))
        yield log(nanoseconds(phase.began), "steps", f"step {phase.number}, {phase.label}")


def alarms(record: RunRecord) -> Iterator[TimedMessage]:
    """Faults and warnings of the run, and their acknowledgement as long as it lasted."""
    ended = record.head.ended
    for alarm in record.alarms:
        events: list[tuple[str, datetime, str | None]] = [("raised", alarm.time, None)]
        if alarm.acknowledged is not None and ended is not None and alarm.acknowledged <= ended:
            events.append(("acknowledged", alarm.acknowledged, alarm.acknowledged_by))
        for event, time, who in events:
            values = {"number": alarm.number, "text": alarm.text, "event": event, "who": who}
            content = JsonValues("cellctl.Alarm", values)
            yield TimedMessage(nanoseconds(time), "/alarms", content)
        yield log(nanoseconds(alarm.time), "alarms", alarm.text, Log.ERROR)


def states_in_log(messages: list[TimedMessage]) -> Iterator[TimedMessage]:
    """Changes of state, and what the cell said that it was doing."""
    state = doing = ""
    for message in messages:
        if message.topic != _STATE or not isinstance(message.content, RecordedJson):
            continue
        values = json.loads(message.content.data)
        if values["state"] != state:
            state = values["state"]
            yield log(message.time_ns, "unit", f"state {state}")
        if values["message"] != doing:
            doing = values["message"]
            if doing:
                yield log(message.time_ns, "unit", doing)


def log(
    time_ns: int, name: str, text: str, level: "Log.Level.ValueType" = Log.INFO
) -> TimedMessage:
    """A line of the log."""
    content = Log(timestamp=stamp(time_ns), level=level, message=text, name=name)
    return TimedMessage(time_ns, LOG, content)
