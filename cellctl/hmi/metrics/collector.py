"""What holds now, read from the newest messages of the daemon when somebody asks."""

import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from cellctl.clock import utc_now
from cellctl.hmi.hub import Hub
from cellctl.hmi.metrics import table
from cellctl.packml.state import STATES
from cellctl.records.database.schema_version import FILE
from cellctl.records.files.delivery_file import NAME, read_state
from cellctl.version import software

Sample = tuple[tuple[str, ...], float]
"""Values of the labels, and the value."""
_FRESH_S = 1.5
"""An older snapshot says nothing about now: its values are left out, as the page strikes them."""
_REACTIONS = ("warn", "hold", "stop", "abort")


class SnapshotCollector(Collector):
    """Asked by the registry for each answer."""

    def __init__(
        self,
        hub: Hub,
        clients: Callable[[], int],
        data_dir: Path,
        forwarder_dir: Path,
    ) -> None:
        self._hub = hub
        self._clients = clients
        self._data_dir, self._forwarder_dir = data_dir, forwarder_dir

    def collect(self) -> Iterator[Metric]:
        """All gauges; those of the cell only while what it says is fresh."""
        hub = self._hub
        age_s = hub.age_s
        yield _family(table.DAEMON_LINKED, _one(float(hub.linked)))
        yield _family(table.SNAPSHOT_AGE, _one(age_s))
        yield _family(table.CLIENTS, _one(float(self._clients())))
        yield from _store(self._data_dir)
        yield from _delivery(self._forwarder_dir)
        if age_s is not None and age_s <= _FRESH_S:
            yield from _unit(hub.snapshot)
            yield from _figures(hub.snapshot)
            yield from _forces(hub.snapshot)
            yield from _guards(hub.snapshot)
            yield from _daemon(hub.snapshot)
            yield from _devices(hub.snapshot)
        if hub.description:
            yield from _calibrations(hub.description)


def _unit(now: Mapping[str, Any]) -> Iterator[Metric]:
    states = [((state.name,), float(state.name == now["state"])) for state in STATES]
    yield _family(table.STATE, states)
    yield _family(table.STEP, _one(now["step"]["number"]))
    yield _family(table.LINE_ALIVE, _one(float(now["line_alive"])))
    yield _family(table.READY, _one(float(now["ready"])))
    yield _family(table.GOOD_PARTS, _one(now["run"]["good_parts"]))
    reactions = [one["reaction"] for one in now["alarms"]]
    counts = [((reaction,), float(reactions.count(reaction))) for reaction in _REACTIONS]
    yield _family(table.ALARMS_ACTIVE, counts)
    # No serial numbers: each would be a series of its own, for ever.
    labels = software(), str(now["simulated"]).lower()
    yield _family(table.BUILD_INFO, [(labels, 1.0)])


def _figures(now: Mapping[str, Any]) -> Iterator[Metric]:
    known = [one for one in now["errors"] if one["value"] is not None]
    named = [((f"error_{one['axis']}", one["unit"]), one["value"]) for one in known]
    yield _family(table.FIGURE, named)
    shares = [
        ((f"error_{one['axis']}",), abs(one["value"]) / one["limit"])
        for one in known
        if one["limit"]
    ]
    yield _family(table.LIMIT_RATIO, shares)


def _forces(now: Mapping[str, Any]) -> Iterator[Metric]:
    sensors = now["forces"]
    axes = [
        ((sensor["sensor"], axis["axis"]), axis["unit"], axis["value"])
        for sensor in sensors
        for axis in sensor["wrench"]
        if axis["value"] is not None
    ]
    yield _family(table.FORCE, [(labels, value) for labels, unit, value in axes if unit == "N"])
    yield _family(table.MOMENT, [(labels, value) for labels, unit, value in axes if unit != "N"])
    peaks = [
        ((sensor["sensor"], axis), value)
        for sensor in sensors
        for axis, value in zip(("Fx", "Fy", "Fz"), sensor["peaks"], strict=False)
        if value is not None
    ]
    yield _family(table.FORCE_PEAK, peaks)
    limits = [((one["sensor"],), one["limit_n"]) for one in sensors if one["limit_n"] is not None]
    yield _family(table.FORCE_LIMIT, limits)
    trips = [((one["sensor"],), float(bool(one["trip"]))) for one in sensors]
    yield _family(table.GUARD_TRIPPED, trips)
    ages = [((one["sensor"],), one["age_s"]) for one in sensors if one["age_s"] is not None]
    yield _family(table.SAMPLE_AGE, ages)


def _guards(now: Mapping[str, Any]) -> Iterator[Metric]:
    guards = now["guards"]
    # The guard counts by itself, and begins at 0 when it is started anew: that is a counter.
    late = CounterMetricFamily(
        table.GUARD_LATE.name, table.GUARD_LATE.text, labels=table.GUARD_LATE.labels
    )
    for name, guard in guards.items():
        late.add_metric((name,), guard["late_wakeups"])
    yield late
    ages = [((name,), one["flange_age_s"]) for name, one in guards.items()]
    yield _family(table.FLANGE_AGE, [(labels, age) for labels, age in ages if age is not None])


def _daemon(now: Mapping[str, Any]) -> Iterator[Metric]:
    daemon = now["daemon"]
    yield _family(table.LOOP_LATE, _one(daemon["loop_late_s"]))
    yield _family(table.LINE_BEAT_AGE, _one(daemon["line_beat_age_s"]))
    yield _family(table.DAEMON_BYTES, _one(daemon["resident_bytes"]))


def _devices(now: Mapping[str, Any]) -> Iterator[Metric]:
    links = [((name,), float(not problem)) for name, problem in now["links"].items()]
    yield _family(table.LINK_UP, links)


def _calibrations(described: Mapping[str, Any]) -> Iterator[Metric]:
    found = described["calibrations"]
    ends = [
        ((one["kind"],), datetime.fromisoformat(one["valid_until"]).timestamp())
        for one in found
        if one["valid_until"]
    ]
    yield _family(table.CALIBRATION_EXPIRY, ends)
    whole = [((one["kind"],), float(not one["problem"])) for one in found]
    yield _family(table.CALIBRATION_OK, whole)


def _store(data_dir: Path) -> Iterator[Metric]:
    files = (data_dir / f"{FILE}{end}" for end in ("", "-wal"))
    try:
        used = sum(path.stat().st_size for path in files if path.exists())
        free = shutil.disk_usage(data_dir).free
    except OSError:
        return  # a store that is away has no size, and the other figures are wanted all the same
    yield _family(table.STORE_BYTES, _one(used))
    yield _family(table.DISK_FREE, _one(free))


def _delivery(forwarder_dir: Path) -> Iterator[Metric]:
    try:
        state = read_state((forwarder_dir / NAME).read_text("utf-8"))
    except (OSError, UnicodeDecodeError):
        return  # no forwarder on this PC, as for a cell that belongs to no fleet; or a damaged file
    if state is None:
        return
    delivered = None if state.delivered is None else state.delivered.timestamp()
    yield _family(table.FLEET_WAITING, _one(state.still_to_come))
    yield _family(table.FLEET_DELIVERED, _one(delivered))
    failing = bool(state.fault) or state.silent(utc_now())
    yield _family(table.FLEET_FAILING, _one(float(failing)))


def _one(value: float | None) -> list[Sample]:
    return [] if value is None else [((), value)]


def _family(metric: table.Metric, samples: Iterable[Sample]) -> Metric:
    family = GaugeMetricFamily(metric.name, metric.text, labels=metric.labels)
    for labels, value in samples:
        family.add_metric(labels, value)
    return family
