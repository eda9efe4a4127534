"""Links, trips, heartbeat, and the death of a part of the daemon."""

import asyncio

import pytest

from cellctl.cell.time_limits import TimeLimits
from cellctl.config import CellConfig
from cellctl.daemon.app import until_told
from cellctl.daemon.supervision import LinkMonitor
from cellctl.errors.force import GuardDied
from cellctl.errors.internal import Unexpected
from cellctl.errors.line import LineTaskDied
from cellctl.errors.link import CallerRefused, ConnectTimeout, PortInUse, StaleData
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from tests.unit.daemon_rig import DaemonRig, PaperPort

TRIP = GuardTrip(TripReason.FILTERED_LIMIT, 1.0, "Fz 60 N", 2, 60.0)


def watch(rig: DaemonRig) -> LinkMonitor:
    return LinkMonitor(rig.bench.as_cell, rig.unit)


async def alarms(rig: DaemonRig) -> list[int]:
    await rig.unit.background.drain()
    return [alarm.number for alarm in await rig.archive.do(type(rig.archive._store).active_alarms)]


async def test_a_broken_link_is_reported_once_until_it_is_whole_again(rig: DaemonRig) -> None:
    await rig.idle()
    links = watch(rig)
    await links.look()
    assert rig.unit.machine.state is State.IDLE
    rig.bench.cell.aux_1.faults["state"] = StaleData("2 s")
    await links.look()
    await links.look()
    await rig.to(State.ABORTED)
    assert await alarms(rig) == [207]
    del rig.bench.cell.aux_1.faults["state"]
    await links.look()
    rig.bench.cell.aux_1.faults["state"] = StaleData("2 s")
    await links.look()
    assert await alarms(rig) == [207, 207]


async def test_what_a_driver_has_refused_is_an_alarm(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    await rig.idle()
    incidents = [CallerRefused("SR500A STA: 192.0.2.66 called")]
    monkeypatch.setattr(
        type(rig.bench.cell.main),
        "incidents",
        lambda _robot: (incidents.pop(),) if incidents else (),
    )
    links = watch(rig)
    await links.look()
    await links.look()
    assert await alarms(rig) == [212]
    assert rig.unit.machine.state is State.IDLE


REFUSED = "no SCHED_FIFO: Operation not permitted"


async def test_a_guard_without_real_time_scheduling_is_an_alarm_of_a_real_cell(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(CellConfig, "simulated", False)
    await rig.idle()
    guard = rig.bench.cell.guard
    guard.degraded = (REFUSED,)
    links = watch(rig)
    await links.look()
    await links.look()
    assert await alarms(rig) == [514], "once"
    status = rig.shown()
    assert (status.state, status.warning, status.error) == (State.IDLE, True, False)
    assert status.ready, "a late guard protects more than none"
    guard.degraded = ()
    await links.look()
    guard.degraded = (REFUSED,)
    await links.look()
    assert await alarms(rig) == [514, 514], "granted in between, then refused again"


async def test_a_simulated_cell_does_not_warn_of_real_time(rig: DaemonRig) -> None:
    await rig.idle()
    rig.bench.cell.guard.degraded = (REFUSED,)
    await watch(rig).look()
    assert await alarms(rig) == []


async def test_the_death_of_the_guard_aborts_a_run(rig: DaemonRig) -> None:
    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()
    guard = rig.bench.cell.guard
    guard.faults["check"] = GuardDied("killed")
    guard.trip = GuardTrip(TripReason.GUARD_DIED, 1.0, "killed")
    await watch(rig).look()
    await rig.to(State.ABORTED)
    assert (await rig.record()).head.fault_number == 510
    assert await alarms(rig) == [510], "one death, one alarm"


async def test_a_trip_nobody_waits_for_is_a_fault(rig: DaemonRig) -> None:
    await rig.idle()
    rig.bench.cell.guard.trip = TRIP
    links = watch(rig)
    await links.look()
    await links.look()
    await rig.to(State.ABORTED)
    assert await alarms(rig) == [512]
    await rig.idle()
    rig.bench.cell.guard.trip = GuardTrip(TripReason.RAW_LIMIT, 2.0, "Fx 40 N", 0, 40.0)
    await links.look()
    assert await alarms(rig) == [512, 512]


async def test_devices_that_are_not_there_leave_the_unit_aborted_until_clear_finds_them(
    rig: DaemonRig,
) -> None:
    await rig.bench.cell.disconnect()
    await rig.unit.machine.command(Command.ABORT)
    await rig.to(State.ABORTED)
    rig.bench.cell.aux_1.faults = {
        "connect": ConnectTimeout("aux_1"),
        "state": StaleData("never"),
    }
    rig.bench.cell.main.faults["connect"] = PortInUse("7001")
    for missing in ("ConnectTimeout of both", "PortInUse"):
        await rig.unit.come_up()
        await watch(rig).look()
        status = rig.shown()
        assert (status.state, status.error) == (State.ABORTED, True), missing
        assert status.first_out_alarm == (201 if "both" in missing else 206)
        assert await rig.take(Command.RESET) is not RejectCode.NONE
        rig.bench.cell.aux_1.faults.clear()
    rig.bench.cell.main.faults.clear()
    assert await rig.take(Command.CLEAR) is RejectCode.NONE
    await rig.to(State.STOPPED)
    assert rig.unit.live
    assert await alarms(rig) == [201, 206]
    assert not any(robot.moves for robot in rig.bench.cell.robots.values())
    await rig.idle()


async def test_contact_deals_with_its_trips_itself(rig: DaemonRig) -> None:
    await rig.idle()
    rig.unit.board.update(step=50, step_label="mate", contact=True)
    rig.bench.cell.guard.trip = TRIP
    links = watch(rig)
    await links.look()
    rig.unit.board.leave_step()
    await links.look()
    assert rig.unit.machine.state is State.IDLE
    assert await alarms(rig) == []


class Port(PaperPort):
    """A port whose command task lives as the test wants."""

    def __init__(self) -> None:
        super().__init__()
        self.death: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    async def failed(self) -> None:
        await self.death


async def supervised(rig: DaemonRig, stop: asyncio.Event) -> tuple[Port, asyncio.Task[None]]:
    port = Port()
    task = asyncio.create_task(until_told(stop, rig.supervision(port)))
    await rig.until(lambda: port.beats > 0)
    return port, task


async def test_a_signal_ends_the_supervision(rig: DaemonRig) -> None:
    stop = asyncio.Event()
    _, task = await supervised(rig, stop)
    stop.set()
    await asyncio.wait_for(task, 5)


async def test_a_dead_line_task_is_its_own_fault(rig: DaemonRig) -> None:
    port, task = await supervised(rig, asyncio.Event())
    port.death.set_exception(LineTaskDied("KeyError"))
    with pytest.raises(LineTaskDied):
        await asyncio.wait_for(task, 5)


async def test_a_defect_in_the_daemon_aborts_the_run_with_901(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()
    _, task = await supervised(rig, asyncio.Event())

    def defect() -> dict[str, object]:
        raise KeyError("defect")

    monkeypatch.setattr(rig.bench.cell, "health_checks", defect)
    with pytest.raises(Unexpected, match="KeyError"):
        await asyncio.wait_for(task, 5)
    await rig.unit.close(Unexpected("KeyError in the daemon"))
    assert rig.unit.machine.state is State.ABORTED
    head = (await rig.record()).head
    assert (head.result, head.fault_number) == ("aborted", 901)
    assert all(robot.latched for robot in rig.bench.cell.robots.values())


async def test_a_machine_that_hangs_is_given_up(rig: DaemonRig) -> None:
    rig.bench.cell.time_limits = TimeLimits(abort_s=0.05)
    await rig.idle()
    async with rig.unit.machine._turn:
        await asyncio.wait_for(rig.unit.close(Unexpected("defect")), 5)
    assert not rig.unit.live
