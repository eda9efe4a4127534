"""The metrics as Prometheus reads them, with its own parser, from a real process of the page."""

from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.parser import text_string_to_metric_families

from cellctl.clock import utc_now
from cellctl.hmi.metrics.history import CellHistory
from cellctl.hmi.metrics.table import METRICS, metrics_table
from cellctl.records.files.delivery_file import NAME, DeliveryState, write_state
from tests.rigs.waiting import until_blocking
from tests.unit.hmi.conftest import TOKEN
from tests.unit.hmi.http_client import Client
from tests.unit.hmi.scripted_daemon import PaperDaemon, alarm, snapshot

PAGE = Path(__file__).parents[4] / "docs" / "metrics.md"
Values = dict[tuple[str, tuple[tuple[str, str], ...]], float]


def parsed(text: bytes) -> Values:
    """Values by name and labels; a series that comes twice fails."""
    found: Values = {}
    for family in text_string_to_metric_families(text.decode()):
        for sample in family.samples:
            key = sample.name, tuple(sorted(sample.labels.items()))
            assert key not in found
            found[key] = sample.value
    return found


def value(found: Values, name: str, /, **labels: str) -> float | None:
    return found.get((f"cellctl_{name}", tuple(sorted(labels.items()))))


def asked(page: Client) -> Values:
    reply = page.get("metrics")
    assert reply.status == 200
    assert reply.headers["content-type"].startswith("text/plain; version=")
    return parsed(reply.body)


def test_the_newest_snapshot_is_served(page: Client, paper: PaperDaemon) -> None:
    errors = [{"axis": "x", "unit": "mm", "value": -0.02, "limit": 0.05}]
    step = {"number": 50, "label": "mate", "text": ""}
    paper.snapshot = snapshot(
        state="EXECUTE", errors=errors, step=step, line_alive=True,
        alarms=[alarm(512, "force"), alarm(635, "payload", "warn")],
        links={"robots.main": "", "force_sensors.wrist": "F207 silent"},
    )  # fmt: skip
    found = until_blocking(
        partial(asked, page), lambda now: value(now, "state", state="EXECUTE") == 1.0
    )
    assert value(found, "state", state="IDLE") == 0.0
    assert value(found, "step") == 50.0
    assert value(found, "line_alive") == 1.0
    assert value(found, "figure", name="error_x", unit="mm") == -0.02
    assert value(found, "figure_limit_ratio", name="error_x") == pytest.approx(0.4)
    assert value(found, "force_newtons", sensor="wrist", axis="Fz") == 1.5
    assert value(found, "force_limit_newtons", sensor="wrist") == 50.0
    assert value(found, "sample_age_seconds", device="wrist") == 0.001
    assert value(found, "guard_late_wakeups_total", sensor="wrist") == 3.0
    assert value(found, "guard_flange_age_seconds", sensor="wrist") == 0.004
    assert value(found, "line_beat_age_seconds") == 0.3
    assert value(found, "daemon_loop_late_seconds") == 0.02
    assert value(found, "daemon_resident_bytes") == 2e8
    assert value(found, "link_up", device="robots.main") == 1.0
    assert value(found, "link_up", device="force_sensors.wrist") == 0.0
    assert value(found, "alarms_active", reaction="abort") == 1.0
    assert value(found, "alarms_active", reaction="hold") == 0.0
    ends = value(found, "calibration_expiry_timestamp_seconds", kind="head")
    assert ends == datetime(2036, 1, 2, 3, 4, 5, tzinfo=UTC).timestamp()
    assert value(found, "daemon_linked") == 1.0
    assert (value(found, "store_bytes") or 0) > 0
    assert (value(found, "store_disk_free_bytes") or 0) > 0
    (build,) = (labels for name, labels in found if name == "cellctl_build_info")
    assert ("simulated", "true") in build


def test_what_is_old_is_not_served_as_new(page: Client, paper: PaperDaemon) -> None:
    until_blocking(partial(asked, page), lambda now: value(now, "state", state="IDLE") == 1.0)
    paper.silent = True
    found = until_blocking(
        partial(asked, page), lambda now: value(now, "state", state="IDLE") is None
    )
    assert (value(found, "hmi_snapshot_age_seconds") or 0.0) > 1.5
    assert value(found, "force_newtons", sensor="wrist", axis="Fz") is None
    assert value(found, "state_seconds_total", state="IDLE") is not None


def test_who_may_read_them(page: Client) -> None:
    """They are for whom every view is: a panel, a token, or somebody who has signed in."""
    assert page.get("metrics", X_Forwarded_For="10.0.0.9").status == 401
    elsewhere = {"X_Forwarded_For": "10.0.0.9", "Authorization": f"Bearer {TOKEN}line"}
    assert page.get("metrics", **elsewhere).status == 200


def test_every_metric_is_in_the_table_and_every_row_is_served(
    page: Client, paper: PaperDaemon, settings: Path
) -> None:
    wrench = [{"axis": "Fx", "unit": "N", "value": 1.0, "limit": None},
              {"axis": "Mx", "unit": "N·m", "value": 0.1, "limit": None}]  # fmt: skip
    delivered = DeliveryState(told=utc_now(), delivered=utc_now(), still_to_come=0)
    write_state(settings.parent / "forwarder", delivered)
    force = snapshot()["forces"][0] | {"wrench": wrench, "peaks": [3.0] * 6}
    errors = [{"axis": "x", "unit": "mm", "value": 0.1, "limit": 0.2}]
    paper.snapshot = snapshot(forces=[force], errors=errors)
    until_blocking(
        partial(asked, page), lambda now: value(now, "figure", name="error_x", unit="mm") == 0.1
    )
    paper.snapshot = snapshot(forces=[force], errors=errors, alarms=[alarm(512, "force")],
                              step={"number": 10, "label": "look", "text": ""})  # fmt: skip
    until_blocking(partial(asked, page), lambda now: value(now, "step") == 10.0)
    paper.snapshot = snapshot(forces=[force], errors=errors)
    until_blocking(partial(asked, page), lambda now: value(now, "step") == 0.0)
    families = {
        family.name: family
        for family in text_string_to_metric_families(page.get("metrics").body.decode())
    }
    for metric in METRICS:
        family = families.pop(metric.name.removesuffix("_total"))
        assert (family.type, family.documentation) == (metric.kind, metric.text)
        labels = {name for sample in family.samples for name in sample.labels} - {"le"}
        assert labels == set(metric.labels), metric.name
    assert not families


def test_a_delivery_that_fails_or_falls_silent_is_told(page: Client, settings: Path) -> None:
    assert value(asked(page), "fleet_delivery_failing") is None, "this cell has no forwarder"
    state = DeliveryState(told=utc_now(), delivered=None, still_to_come=12, fault="F831 away")
    for told, failing in (
        (state, 1.0),
        (state.model_copy(update={"fault": ""}), 0.0),
        (state.model_copy(update={"fault": "", "told": utc_now() - timedelta(hours=1)}), 1.0),
    ):
        write_state(settings.parent / "forwarder", told)
        found = asked(page)
        assert value(found, "fleet_entries_waiting") == 12.0
        assert value(found, "fleet_delivered_timestamp_seconds") is None
        assert value(found, "fleet_delivery_failing") == failing
    for damaged in (b"{", b"\xff\x00"):
        (settings.parent / "forwarder" / NAME).write_bytes(damaged)
        assert value(asked(page), "fleet_entries_waiting") is None


def test_the_page_of_metrics_is_current() -> None:
    assert metrics_table() in PAGE.read_text(encoding="utf-8")


class Told:
    """Snapshots of a cell whose clock the test moves."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self.history = CellHistory(self.registry)
        self.mono_s = 100.0

    def tell(self, passed_s: float, **changes: Any) -> None:
        # As often as the daemon sends them: what is farther apart counts as a gap.
        steps = max(1, round(passed_s))
        for _ in range(steps):
            self.mono_s += passed_s / steps
            self.history.take(snapshot(**changes) | {"mono_s": self.mono_s})

    @property
    def values(self) -> Values:
        return parsed(generate_latest(self.registry))


@pytest.fixture
def told() -> Told:
    return Told()


def run_of(number: int, result: str) -> dict[str, Any]:
    return {"number": number, "serial": "S", "recipe": 1, "result": result, "good_parts": 0}


def test_a_run_its_steps_and_its_states_are_timed(told: Told) -> None:
    look, mate = {"number": 10, "label": "look"}, {"number": 50, "label": "mate"}
    told.tell(5.0, run=run_of(7, "good"))
    told.tell(1.0, state="STARTING", run=run_of(7, "good"))
    told.tell(20.0, state="EXECUTE", step=look, run=run_of(8, "none"))
    told.tell(10.0, state="EXECUTE", step=mate, run=run_of(8, "none"))
    told.tell(1.0, state="COMPLETED", run=run_of(8, "good"))
    told.tell(9.0, state="COMPLETED", run=run_of(8, "good"))
    found = told.values
    assert value(found, "runs_total", result="good") == 1.0
    assert value(found, "runs_total", result="bad") == 0.0
    assert value(found, "run_duration_seconds_count") == 1.0
    assert value(found, "run_duration_seconds_sum") == pytest.approx(30.0)
    assert value(found, "step_duration_seconds_sum", step="look") == pytest.approx(20.0)
    assert value(found, "step_duration_seconds_sum", step="mate") == pytest.approx(10.0)
    assert value(found, "state_seconds_total", state="EXECUTE") == pytest.approx(30.0)


def test_an_alarm_is_counted_once_and_one_that_stood_before_not_at_all(told: Told) -> None:
    stood = alarm(635, "payload", "warn")
    told.tell(1.0, alarms=[stood])
    told.tell(3.0, alarms=[stood, alarm(512, "force")])
    found = told.values
    assert value(found, "alarms_total", number="512") == 1.0
    assert value(found, "alarms_total", number="635") is None


def test_time_in_which_nothing_was_heard_belongs_to_no_state(told: Told) -> None:
    step = {"number": 10, "label": "look", "text": ""}
    told.tell(1.0, state="STARTING")
    told.tell(1.0, state="EXECUTE", step=step, run=run_of(8, "none"))
    told.mono_s += 60.0
    told.tell(1.0, state="COMPLETED", run=run_of(8, "good"))
    found = told.values
    assert value(found, "state_seconds_total", state="EXECUTE") == 0.0
    # How long the run took is not known, and that it has ended is.
    assert value(found, "run_duration_seconds_count") == 0.0
    assert value(found, "runs_total", result="good") == 1.0
