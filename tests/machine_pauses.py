"""A pytest plugin: a test that fails while the machine stood still is tried again.

Drivers, guard and daemon have limits of tens of milliseconds, and the tests hold them to these on
real sockets and processes. A virtual machine may be given no processor for longer than that. What
fails then says nothing about the program: it did what it should on a PC that stops. So the plugin
measures, while each test runs, how long the machine withheld its processors. Only a failure with
such a pause is tried again, at most twice, and the summary names each. Any other failure counts.
"""

import gc
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

import pytest
from _pytest.runner import runtestprotocol

TRIES = 3
PAUSE_S = 0.1
"""The shortest pause that excuses a failure; the tightest limit in the tests is of this size."""
STOLEN_SHARE = 0.03
"""Share of the processor time that other guests of the host take, which excuses a test too.

The programs that a test has started may stand still while the test itself does not.
"""
_LOOK_S = 0.025
_PROPERTY = "machine stood still"


class PauseWatch:
    """Measures the longest time for which this process wanted to run and could not.

    A thread sleeps for moments and looks how late it wakes. What the process computed meanwhile is
    taken off: a long call into native code is work of the test, not a pause of the machine.
    """

    def __init__(self) -> None:
        self.longest_s = 0.0
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._look, name="pause-watch", daemon=True)

    def __enter__(self) -> Self:
        self._stolen_s, self._passed_s = _processor_times_s()
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._ended.set()
        self._thread.join()
        stolen_s, passed_s = _processor_times_s()
        self._stolen_s = stolen_s - self._stolen_s
        self._passed_s = passed_s - self._passed_s

    def excuse(self) -> str | None:
        """Why a failure during the watch says nothing; None if it counts. Valid after the end."""
        if self.longest_s >= PAUSE_S:
            return f"for {self.longest_s:.2f} s"
        if self._stolen_s >= max(PAUSE_S, STOLEN_SHARE * self._passed_s):
            return f"for {self._stolen_s:.1f} s of {self._passed_s:.1f} s of its processors"
        return None

    def _look(self) -> None:
        wall_s, worked_s = time.monotonic(), time.process_time()
        while not self._ended.wait(_LOOK_S):
            wall_before_s, worked_before_s = wall_s, worked_s
            wall_s, worked_s = time.monotonic(), time.process_time()
            late_s = wall_s - wall_before_s - _LOOK_S - (worked_s - worked_before_s)
            self.longest_s = max(self.longest_s, late_s)


def _processor_times_s() -> tuple[float, float]:
    """Time stolen by the host and all time so far, of all processors (man 5 proc_stat)."""
    ticks = [int(word) for word in Path("/proc/stat").read_text().splitlines()[0].split()[1:9]]
    return ticks[7] / 100, sum(ticks) / 100


@contextmanager
def _announced(item: pytest.Item) -> Iterator[None]:
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    yield
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool:
    """Run a test; once more if it failed while the machine stood still."""
    with _announced(item):
        for tries_left in reversed(range(TRIES)):
            with PauseWatch() as watch:
                reports = runtestprotocol(item, nextitem=nextitem, log=False)
            excuse = watch.excuse()
            if not (tries_left and excuse and any(report.failed for report in reports)):
                break
            # Fixtures of wider scope may have failed as well: everything is set up anew.
            item.session._setupstate.teardown_exact(None)
            reports = []
            _forget_failure()
            item.user_properties.append((_PROPERTY, excuse))
        for report in reports:
            item.ihook.pytest_runtest_logreport(report=report)
    return True


def _forget_failure() -> None:
    """Let go of sockets and programs that the failed try has left open, without the warnings.

    A test that fails does not reach its last lines. What it leaves would be reported as an error at
    the end of the session, although its failure was excused.
    """
    # The runner keeps the last exception for debuggers, and with it every variable of the test.
    for name in ("last_exc", "last_type", "last_value", "last_traceback"):
        if hasattr(sys, name):
            delattr(sys, name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        gc.collect()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Name the tests that were tried again."""
    again = {
        (report.nodeid, excuse)
        for reports in terminalreporter.stats.values()
        for report in reports
        for name, excuse in getattr(report, "user_properties", ())
        if name == _PROPERTY
    }
    for nodeid, excuse in sorted(again):
        terminalreporter.write_line(f"TRIED AGAIN {nodeid}: the machine stood still {excuse}")
