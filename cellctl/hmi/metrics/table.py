"""Every metric with unit, labels and meaning; `docs/metrics.md` shows this table."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Metric:
    """A metric as it is served; counters end in ``_total``."""

    name: str
    kind: str
    """gauge, counter or histogram."""
    unit: str
    """Unit of its value; empty for numbers and flags."""
    labels: tuple[str, ...]
    text: str


def _gauge(name: str, unit: str, text: str, *labels: str) -> Metric:
    return Metric(f"cellctl_{name}", "gauge", unit, labels, text)


def _counter(name: str, unit: str, text: str, *labels: str) -> Metric:
    return Metric(f"cellctl_{name}_total", "counter", unit, labels, text)


STATE = _gauge("state", "", "1 for the PackML state that the unit is in, 0 for the others", "state")
STATE_SECONDS = _counter(
    "state_seconds", "s", "time in each state while the daemon was followed", "state"
)
STEP = _gauge("step", "", "number of the step, 0 between runs")
LINE_ALIVE = _gauge("line_alive", "", "1 while the heartbeat of the line PLC is present")
READY = _gauge("ready", "", "1 while the cell is ready")
GOOD_PARTS = _gauge("good_parts", "", "good parts since installation")
RUNS = _counter("runs", "", "runs that have ended, by result", "result")
RUN_DURATION = Metric(
    "cellctl_run_duration_seconds", "histogram", "s", (), "from Execute to the result of a run"
)
STEP_DURATION = Metric(
    "cellctl_step_duration_seconds", "histogram", "s", ("step",), "time of each step"
)
FIGURE = _gauge("figure", "as unit says", "newest error by axis", "name", "unit")
LIMIT_RATIO = _gauge("figure_limit_ratio", "1", "magnitude of it as a share of its limit", "name")
FORCE = _gauge(
    "force_newtons", "N", "contact force, without the weight of the part", "sensor", "axis"
)
MOMENT = _gauge("moment_newton_meters", "N·m", "contact moment, likewise", "sensor", "axis")
FORCE_PEAK = _gauge(
    "force_peak_newtons", "N", "greatest force of the present contact", "sensor", "axis"
)
FORCE_LIMIT = _gauge("force_limit_newtons", "N", "force at which the guard trips", "sensor")
_TRIPPED = "1 while a trip is latched, other than the touch that a step waits for"
GUARD_TRIPPED = _gauge("guard_tripped", "", _TRIPPED, "sensor")
SAMPLE_AGE = _gauge("sample_age_seconds", "s", "age of the newest sample of a sensor", "device")
GUARD_LATE = _counter(
    "guard_late_wakeups", "", "times that a guard woke more than a millisecond late", "sensor"
)
FLANGE_AGE = _gauge(
    "guard_flange_age_seconds",
    "s",
    "age of the pose that a guard has from its robot",
    "sensor",
)
LINE_BEAT_AGE = _gauge(
    "line_beat_age_seconds", "s", "since the counter of the line PLC in command has changed"
)
LOOP_LATE = _gauge(
    "daemon_loop_late_seconds", "s", "latest turn of the daemon's event loop within 15 s"
)
DAEMON_BYTES = _gauge("daemon_resident_bytes", "B", "memory of the daemon, without its children")
LINK_UP = _gauge(
    "link_up", "", "1 while a device answers and no fault of its link is latched", "device"
)
CALIBRATION_EXPIRY = _gauge(
    "calibration_expiry_timestamp_seconds", "s since 1970", "end of a calibration", "kind"
)
CALIBRATION_OK = _gauge("calibration_ok", "", "1 while nothing is wrong with it", "kind")
ALARMS_ACTIVE = _gauge(
    "alarms_active", "", "alarms that nobody has acknowledged, by what they led to", "reaction"
)
ALARMS = _counter("alarms", "", "alarms that have come, by fault number", "number")
DAEMON_LINKED = _gauge("daemon_linked", "", "1 while the daemon is followed")
SNAPSHOT_AGE = _gauge("hmi_snapshot_age_seconds", "s", "age of what the daemon has said last")
CLIENTS = _gauge("hmi_clients", "", "pages that are open")
STORE_BYTES = _gauge("store_bytes", "B", "database of the run store, without its files")
DISK_FREE = _gauge("store_disk_free_bytes", "B", "free on the disk of the run store")
FLEET_WAITING = _gauge(
    "fleet_entries_waiting", "", "entries of the ledger that the fleet database does not have yet"
)
FLEET_DELIVERED = _gauge(
    "fleet_delivered_timestamp_seconds", "s since 1970", "when records were delivered last"
)
FLEET_FAILING = _gauge(
    "fleet_delivery_failing", "", "1 while the forwarder delivers nothing, or is silent"
)
BUILD_INFO = _gauge("build_info", "", "1, with version and SIMULATED", "version", "simulated")

METRICS = (
    STATE, STATE_SECONDS, STEP, LINE_ALIVE, READY, GOOD_PARTS, RUNS, RUN_DURATION, STEP_DURATION,
    FIGURE, LIMIT_RATIO, FORCE, MOMENT, FORCE_PEAK, FORCE_LIMIT, GUARD_TRIPPED, SAMPLE_AGE,
    GUARD_LATE, FLANGE_AGE, LINE_BEAT_AGE, LOOP_LATE, DAEMON_BYTES, LINK_UP, CALIBRATION_EXPIRY,
    CALIBRATION_OK, ALARMS_ACTIVE, ALARMS, DAEMON_LINKED, SNAPSHOT_AGE, CLIENTS, STORE_BYTES,
    DISK_FREE, FLEET_WAITING, FLEET_DELIVERED, FLEET_FAILING, BUILD_INFO,
)  # fmt: skip


def metrics_table() -> str:
    """All metrics as a table in Markdown."""
    rows = (
        f"| `{one.name}` | {one.kind} | {one.unit} | {', '.join(one.labels)} | {one.text} |"
        for one in METRICS
    )
    return "\n".join(("| metric | kind | unit | labels | means |", "|---|---|---|---|---|", *rows))
