"""A disk that fills up or hangs while an arm moves ends the run, between its steps too."""

import shutil
import threading
from collections.abc import Iterator

import pytest

from cellctl.daemon import disk_watch
from cellctl.daemon.disk_watch import DiskWatch
from cellctl.errors.records.store import DiskNearlyFull, RecordNotWritten, RecordSilent
from cellctl.packml.state import State
from cellctl.records.files import disk_space
from cellctl.records.store import RunStore
from tests.unit.daemon_rig import DaemonRig


@pytest.fixture
def watch(rig: DaemonRig) -> DiskWatch:
    return DiskWatch(rig.archive, rig.unit)


@pytest.fixture
def hanging() -> Iterator[threading.Event]:
    """Set at the end, so that the store's thread comes back."""
    goes_on = threading.Event()
    yield goes_on
    goes_on.set()


async def in_contact(rig: DaemonRig) -> None:
    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()


async def test_a_disk_that_writes_is_no_fault(rig: DaemonRig, watch: DiskWatch) -> None:
    await in_contact(rig)
    await watch.look()
    assert rig.unit.machine.state is State.EXECUTE
    assert (rig.store_folder / disk_space.PROBE).read_bytes()


async def test_a_full_disk_ends_the_run(
    rig: DaemonRig, watch: DiskWatch, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise RecordNotWritten("No space left on device")

    await in_contact(rig)
    monkeypatch.setattr(disk_watch, "require_writable", full)
    await watch.look()
    await rig.to(State.ABORTED)
    assert rig.shown().first_out_alarm == RecordNotWritten.number
    await watch.look()  # no run is open: nothing is asked


async def test_a_disk_that_hangs_ends_the_run(
    rig: DaemonRig,
    watch: DiskWatch,
    hanging: threading.Event,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    await in_contact(rig)
    monkeypatch.setattr(disk_watch, "require_writable", lambda _: hanging.wait())
    await watch.look(timeout_s=0.05)
    assert [fault.number for fault in rig.unit.machine.faults] == [RecordSilent.number]
    await watch.look(timeout_s=0.05)
    assert len(rig.unit.machine.faults) == 1, "said once"


async def test_without_a_run_nothing_is_written(rig: DaemonRig, watch: DiskWatch) -> None:
    await rig.idle()
    await watch.look()
    assert not (rig.store_folder / disk_space.PROBE).exists()


async def test_whoever_would_start_hears_before_that_there_is_no_room(
    rig: DaemonRig, watch: DiskWatch, monkeypatch: pytest.MonkeyPatch
) -> None:
    await rig.idle()
    full = shutil.disk_usage("/")._replace(free=10**6)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: full)
    await watch.look()
    await watch.look()
    assert rig.unit.machine.state is State.IDLE
    assert (rig.shown().alarms, rig.shown().ready) == ((DiskNearlyFull.number,), False)
    told = await rig.archive.do(RunStore.active_alarms)
    assert [alarm.number for alarm in told] == [DiskNearlyFull.number], "said once"
    monkeypatch.undo()
    await watch.look()
    assert rig.shown().ready


async def test_a_disk_that_hangs_between_runs_is_asked_once(
    rig: DaemonRig,
    watch: DiskWatch,
    hanging: threading.Event,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    await rig.idle()
    asked = []
    there = shutil.disk_usage("/")

    def hangs(folder: object) -> object:
        asked.append(folder)
        hanging.wait()
        return there

    monkeypatch.setattr(shutil, "disk_usage", hangs)
    for _ in range(3):
        await watch.look(timeout_s=0.01)
    hanging.set()
    await watch.look()
    assert len(asked) == 1
    assert rig.unit.machine.state is State.IDLE


async def test_the_probe_is_no_part_of_the_record(rig: DaemonRig, watch: DiskWatch) -> None:
    await in_contact(rig)
    await watch.look()
    assert await rig.archive.do(RunStore.verify) == []


async def test_a_disk_that_cannot_be_asked_ends_nothing_and_nothing_is_asked_while_arms_move(
    rig: DaemonRig, watch: DiskWatch, monkeypatch: pytest.MonkeyPatch
) -> None:
    def gone(_: object) -> object:
        raise OSError("stale file handle")

    await rig.idle()
    monkeypatch.setattr(shutil, "disk_usage", gone)
    await watch.look()
    assert rig.unit.machine.state is State.IDLE, "Start is refused, and nothing else happens"
    assert not rig.shown().ready
    monkeypatch.undo()
    monkeypatch.setattr(disk_watch, "AT_REST", frozenset())
    await watch.look()
    assert not rig.shown().ready, "not asked"
