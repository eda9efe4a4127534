"""How long a check of the reference counts."""

from datetime import UTC, datetime, timedelta

from cellctl.processes.antenna_module.last_check import LastCheck

NOW = datetime(2026, 5, 4, 12, tzinfo=UTC)
HOUR = timedelta(hours=1)


def test_teaching_counts_as_a_check() -> None:
    assert not LastCheck().due(NOW, NOW - HOUR / 2, HOUR)
    assert LastCheck().due(NOW, NOW - HOUR, HOUR)


def test_the_last_check_counts_where_it_is_newer() -> None:
    assert not LastCheck(NOW - HOUR / 2).due(NOW, NOW - 20 * HOUR, HOUR)
    assert LastCheck(NOW - 2 * HOUR).due(NOW, NOW - 20 * HOUR, HOUR)


def test_without_an_interval_every_run_checks() -> None:
    assert LastCheck(NOW).due(NOW, NOW, timedelta(0))


def test_a_clock_that_was_set_back_does_not_put_it_off() -> None:
    assert LastCheck(NOW + HOUR).due(NOW, NOW - 20 * HOUR, HOUR)
