"""What is told of two snapshots, and what is not."""

from datetime import UTC, datetime, timedelta
from typing import Any

from cellctl.hmi.notifying.events import EventWatch
from tests.unit.hmi.scripted_daemon import alarm, snapshot


def told(watch: EventWatch, **changes: Any) -> list[dict[str, Any]]:
    return list(watch.snapshot(snapshot(**changes)))


def run(number: int, result: str) -> dict[str, Any]:
    return {"number": number, "serial": "SAT-1", "recipe": 1, "result": result, "good_parts": 4}


def test_an_alarm_is_told_once_with_what_to_do() -> None:
    watch = EventWatch()
    assert told(watch, alarms=[alarm(601, "expired", "warn")]) == [], "it stood before"
    standing = [alarm(601, "expired", "warn"), alarm(401, "fault of a device")]
    (message,) = told(watch, alarms=standing, faults=[alarm(401, "fault of a device")])
    assert (message["event"], message["number"], message["cell"]) == ("alarm", 401, "paper cell")
    assert (message["remedy"], message["run"], message["first_out"]) == ("a remedy", 17, True)
    assert told(watch, alarms=standing) == []
    assert told(watch) == []


def test_the_same_fault_again_is_told_again() -> None:
    watch = EventWatch()
    assert told(watch) == []
    assert len(told(watch, alarms=[alarm(401, "x")])) == 1
    assert len(told(watch, alarms=[alarm(401, "x") | {"since": "2026-01-02T04:00:00+00:00"}])) == 1


def test_a_run_is_told_when_it_has_its_result() -> None:
    watch = EventWatch()
    assert told(watch, run=run(4, "good")) == [], "it ended before"
    assert told(watch, run=run(5, "none")) == []
    (message,) = told(watch, run=run(5, "aborted"))
    assert (message["event"], message["number"], message["result"]) == ("run_end", 5, "aborted")
    assert told(watch, run=run(5, "aborted")) == []
    assert told(watch, run=run(0, "none")) == []


def test_a_calibration_that_ends_soon_is_told_once() -> None:
    def description(days: float) -> dict[str, Any]:
        ends = (datetime.now(UTC) + timedelta(days=days)).isoformat()
        return {"calibrations": [{"kind": "head_1", "valid_until": ends}]}

    watch = EventWatch()
    assert list(watch.description(description(30))) == []
    soon = description(3)
    assert [one["calibration"] for one in watch.description(soon)] == ["head_1"]
    assert list(watch.description(soon)) == []
    assert list(watch.description({"calibrations": [{"kind": "x", "valid_until": None}]})) == []


def test_a_daemon_that_goes_and_comes_back() -> None:
    watch = EventWatch()
    assert list(watch.age(None)) == [], "never seen, not missed"
    assert told(watch) == []
    assert list(watch.age(2.0)) == []
    assert [one["event"] for one in watch.age(11.0)] == ["daemon_away"]
    assert list(watch.age(12.0)) == []
    assert [one["event"] for one in told(watch)] == ["daemon_back"]
