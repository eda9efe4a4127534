"""What happened between one message of the daemon and the next."""

from collections.abc import Iterator, Mapping
from datetime import UTC, datetime, timedelta
from enum import StrEnum
from typing import Any

Message = Mapping[str, Any]
_DUE = timedelta(days=14)
"""A calibration is told this long before it ends, as the page marks it."""
_AWAY_S = 10.0
"""A daemon that is away for less was restarted, or the machine stood still."""


class Event(StrEnum):
    """What a receiver may ask for."""

    ALARM = "alarm"
    RUN_END = "run_end"
    CALIBRATION_DUE = "calibration_due"
    DAEMON_AWAY = "daemon_away"
    DAEMON_BACK = "daemon_back"


class EventWatch:
    """Remembers what was told, so that nothing is told twice."""

    def __init__(self) -> None:
        self._alarms: set[tuple[int, str]] | None = None
        """Number and time of those that stood; None before the first snapshot."""
        self._run: tuple[int, str] | None = None
        self._due: set[tuple[str, str]] = set()
        self._away = False
        self._cell = ""

    def snapshot(self, now: Message) -> Iterator[dict[str, Any]]:
        """What a snapshot brings that the one before did not have."""
        self._cell = now["cell"]
        if self._away:
            self._away = False
            yield self._told(Event.DAEMON_BACK, state=now["state"])
        yield from self._new_alarms(now)
        yield from self._run_end(now)

    def description(self, now: Message) -> Iterator[dict[str, Any]]:
        """Calibrations that end soon; each is told once."""
        for one in now["calibrations"]:
            ends = one["valid_until"]
            if ends is None or (one["kind"], ends) in self._due:
                continue
            if datetime.fromisoformat(ends) - datetime.now(UTC) < _DUE:
                self._due.add((one["kind"], ends))
                yield self._told(Event.CALIBRATION_DUE, calibration=one["kind"], valid_until=ends)

    def age(self, age_s: float | None) -> Iterator[dict[str, Any]]:
        """Say that the newest snapshot is this old; None when there has never been one."""
        # A cell that was never seen is not missed: the page may be started long before the daemon.
        if age_s is not None and age_s > _AWAY_S and not self._away:
            self._away = True
            yield self._told(Event.DAEMON_AWAY, age_s=round(age_s, 1))

    def _new_alarms(self, now: Message) -> Iterator[dict[str, Any]]:
        stand = {(one["number"], one["since"]) for one in now["alarms"]}
        before, self._alarms = self._alarms, stand
        if before is None:
            return  # What stood when the page began was told by whoever watched then.
        first = now["faults"][0]["number"] if now["faults"] else None
        for one in now["alarms"]:
            if (one["number"], one["since"]) not in before:
                wanted = ("number", "text", "cause", "remedy", "reaction", "since", "run")
                details = {name: one[name] for name in wanted}
                yield self._told(Event.ALARM, **details, first_out=one["number"] == first)

    def _run_end(self, now: Message) -> Iterator[dict[str, Any]]:
        run = now["run"]
        seen = run["number"], run["result"]
        before, self._run = self._run, seen
        if before is not None and seen != before and run["result"] != "none":
            wanted = {name: run[name] for name in ("number", "serial", "recipe", "result")}
            yield self._told(Event.RUN_END, **wanted, mode=now["mode"])

    def _told(self, event: Event, **details: Any) -> dict[str, Any]:
        time = datetime.now(UTC).isoformat(timespec="milliseconds")
        return {"event": str(event), "cell": self._cell, "time": time, **details}
