"""What the system does not permit is reported and goes on."""

import gc
import os
from collections.abc import Iterator

import pytest

from cellctl.guard.watch import realtime


@pytest.fixture(autouse=True)
def collector() -> Iterator[None]:
    """The measures switch garbage collection off; a test process wants it back.

    What they froze stays so: with it the tests that were collected would thaw, and every later
    collection go through them all (`tests/conftest.py`).
    """
    yield
    gc.enable()


def refuse(*_: object) -> None:
    raise PermissionError(1, "Operation not permitted")


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    made: list[str] = []
    for name in ("sched_setscheduler", "sched_setaffinity", "setpriority"):
        monkeypatch.setattr(os, name, lambda *_, name=name: made.append(name))
    monkeypatch.setattr(realtime, "_lock_memory", lambda: made.append("lock"))
    return made


def test_all_is_permitted(calls: list[str]) -> None:
    assert realtime.enter(60, 1, lock_memory=True) == []
    assert calls == ["lock", "sched_setaffinity", "sched_setscheduler"]
    assert not gc.isenabled()


def test_nothing_is_asked_for(calls: list[str]) -> None:
    assert realtime.enter(0, None, lock_memory=False) == []
    assert calls == []


def test_no_fifo_falls_back_to_nice(calls: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    assert realtime.enter(60, None, lock_memory=False) == ["no SCHED_FIFO: Operation not permitted"]
    assert calls == ["setpriority"]


def test_nothing_is_permitted(calls: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("sched_setscheduler", "sched_setaffinity", "setpriority"):
        monkeypatch.setattr(os, name, refuse)
    monkeypatch.setattr(realtime, "_lock_memory", refuse)
    words = realtime.enter(60, 1, lock_memory=True)
    assert [word.split(":")[0] for word in words] == [
        "memory is not locked",
        "not pinned to processor 1",
        "no SCHED_FIFO",
        "no nice -15",
    ]


def test_resident_peak() -> None:
    assert 1e6 < realtime.resident_peak_bytes() < 1e11
