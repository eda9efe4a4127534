"""The one place that reads the clock. Intervals are monotonic, records are UTC."""

import time
from collections.abc import Callable
from datetime import UTC, datetime, timedelta

Monotonic = Callable[[], float]
"""``now_s``, or what stands in for it where time is simulated. Seconds."""


def now_s() -> float:
    """Monotonic time in seconds, CLOCK_MONOTONIC: the same in every process of this PC."""
    # Named instead of ``time.monotonic``, because stamps of guard and daemon are compared with each
    # other.
    return time.clock_gettime(time.CLOCK_MONOTONIC)


def utc_now() -> datetime:
    """Wall-clock time for records, with its zone."""
    return datetime.now(UTC)


def utc_at(time_s: float) -> datetime:
    """Wall-clock time of a monotonic time, by the offset of both clocks now."""
    return utc_now() - timedelta(seconds=now_s() - time_s)
