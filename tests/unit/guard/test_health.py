"""What the daemon concludes from a guard's status, and which fault it names first."""

import pytest

from cellctl.errors.base import CellError
from cellctl.errors.force import GuardDied, SensorSilent
from cellctl.errors.link import LinkLost
from cellctl.guard.health import GuardHealth
from cellctl.guard.ring import GuardStatus

NOW_S = 100.0
WELL = GuardStatus(
    time_s=NOW_S - 0.02,
    armed=1,
    channel_up=1,
    sensor_open=1,
    sample_time_s=NOW_S - 0.001,
    flange_time_s=NOW_S - 0.004,
)


def health(status: GuardStatus | None) -> GuardHealth:
    return GuardHealth.from_status(status, NOW_S, "4711", ())


def test_a_guard_that_is_well_has_no_fault_and_tells_its_ages() -> None:
    found = health(WELL)
    assert found.fault() is None
    assert (found.armed, found.latched, found.sensor_serial) == (True, False, "4711")
    assert found.sample_age_s == pytest.approx(0.001)
    assert found.flange_age_s == pytest.approx(0.004)


def test_a_guard_without_a_status_is_dead_and_keeps_what_it_was_not_permitted() -> None:
    dead = GuardHealth.from_status(None, NOW_S, "4711", ("no real-time priority",))
    assert not dead.alive
    assert dead.degraded == ("no real-time priority",)
    assert isinstance(dead.fault(), GuardDied)


@pytest.mark.parametrize(
    ("changed", "fault", "says"),
    [
        ({"time_s": NOW_S - 1.5}, GuardDied, "more than 1 s old"),
        ({"sensor_open": 0}, SensorSilent, "has given it up"),
        ({"channel_up": 0}, LinkLost, "stop channel"),
        ({"sample_time_s": NOW_S - 2.5}, SensorSilent, "no sample for 2.5 s"),
        # Each of these follows from the one before it, which is therefore named.
        ({"time_s": 0.0, "sensor_open": 0, "channel_up": 0}, GuardDied, "old"),
        ({"sensor_open": 0, "channel_up": 0, "sample_time_s": 0.0}, SensorSilent, "given it up"),
        ({"channel_up": 0, "sample_time_s": 0.0}, LinkLost, "stop channel"),
    ],
)
def test_the_cause_is_named_before_what_follows_from_it(
    changed: dict[str, float], fault: type[CellError], says: str
) -> None:
    found = health(WELL._replace(**changed)).fault()  # type: ignore[arg-type]
    assert type(found) is fault
    assert says in found.detail


def test_a_sample_is_not_called_missing_within_a_second() -> None:
    assert health(WELL._replace(sample_time_s=NOW_S - 0.9)).fault() is None
