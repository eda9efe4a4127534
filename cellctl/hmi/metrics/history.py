"""What adds up from snapshot to snapshot: time in states, runs, steps, alarms."""

from collections.abc import Mapping
from typing import Any

from prometheus_client import CollectorRegistry, Counter, Histogram

from cellctl.hmi.metrics.table import (
    ALARMS,
    RUN_DURATION,
    RUNS,
    STATE_SECONDS,
    STEP_DURATION,
    Metric,
)
from cellctl.packml.state import STATES
from cellctl.records.entries import RunResult

_GAP_S = 1.5
"""Snapshots that are farther apart leave a time of which nobody knows what the cell did."""
_RUN_S = (15, 30, 45, 60, 90, 120, 180, 300, 600, 1200)
_STEP_S = (1, 2, 5, 10, 15, 20, 30, 60, 120, 300)
_UNDECIDED = "none"
_EXECUTE = "EXECUTE"


class CellHistory:
    """Belongs to one event loop; is told every snapshot."""

    def __init__(self, registry: CollectorRegistry) -> None:
        self._state_s = _counter(STATE_SECONDS, registry)
        self._runs = _counter(RUNS, registry)
        self._alarms = _counter(ALARMS, registry)
        self._run_s = Histogram(
            RUN_DURATION.name, RUN_DURATION.text, registry=registry, buckets=_RUN_S
        )
        self._step_s = Histogram(
            STEP_DURATION.name, STEP_DURATION.text, STEP_DURATION.labels, registry=registry,
            buckets=_STEP_S,
        )  # fmt: skip
        # Zeros from the start: a rate over a counter that has just appeared misses its first event.
        for state in STATES:
            self._state_s.labels(state.name)
        for result in RunResult:
            self._runs.labels(result.value)
        self._before: Mapping[str, Any] = {}
        self._executing_s: float | None = None
        """Monotonic begin of the present run; None before it, and when it was not seen."""
        self._step_begun_s: float | None = None

    def take(self, now: Mapping[str, Any]) -> None:
        """The next snapshot. Raises ``LookupError``, ``TypeError`` for one of another version."""
        before, self._before = self._before, now
        if not before:
            return  # what stood when this process began was not seen to come
        passed_s = now["mono_s"] - before["mono_s"]
        seen = 0.0 < passed_s <= _GAP_S
        if seen:
            self._state_s.labels(before["state"]).inc(passed_s)
        else:
            self._executing_s = self._step_begun_s = None
        self._count_alarms(before, now)
        self._time_step(before, now, seen=seen)
        self._time_run(before, now, seen=seen)

    def _count_alarms(self, before: Mapping[str, Any], now: Mapping[str, Any]) -> None:
        stood = {(one["number"], one["since"]) for one in before["alarms"]}
        for one in now["alarms"]:
            if (one["number"], one["since"]) not in stood:
                self._alarms.labels(str(one["number"])).inc()

    def _time_step(self, before: Mapping[str, Any], now: Mapping[str, Any], *, seen: bool) -> None:
        was, step = before["step"]["label"], now["step"]["label"]
        if was == step:
            return
        if was and self._step_begun_s is not None:
            self._step_s.labels(was).observe(now["mono_s"] - self._step_begun_s)
        self._step_begun_s = now["mono_s"] if step and seen else None

    def _time_run(self, before: Mapping[str, Any], now: Mapping[str, Any], *, seen: bool) -> None:
        if now["state"] == _EXECUTE != before["state"] and self._executing_s is None and seen:
            self._executing_s = now["mono_s"]
        was = before["run"]["number"], before["run"]["result"]
        run = now["run"]
        if (run["number"], run["result"]) == was or run["result"] == _UNDECIDED:
            return
        self._runs.labels(run["result"]).inc()
        if self._executing_s is not None:
            self._run_s.observe(now["mono_s"] - self._executing_s)
        self._executing_s = None


def _counter(metric: Metric, registry: CollectorRegistry) -> Counter:
    return Counter(metric.name, metric.text, metric.labels, registry=registry)
