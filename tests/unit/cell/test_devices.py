"""All devices together: connect, stop, rearm, whatever fails."""

import asyncio
from dataclasses import replace

import pytest

from cellctl.cell.devices import Cell
from cellctl.cell.readiness import require_ready
from cellctl.errors.force import GuardDied
from cellctl.errors.link import ConnectTimeout, LinkLost
from cellctl.errors.robot import RobotNotReady, StopFailed
from tests.unit.cell.bench import CELL_FILE, Bench


def test_a_cell_is_built_from_its_file_without_io(bench: Bench) -> None:
    cell = Cell(bench.cell.config, CELL_FILE.parent)
    assert list(cell.robots) == ["main", "aux_1", "aux_2"]
    assert list(cell.stereo_cameras) == ["head_1", "head_2"]
    assert cell.stereo_station("head_2").robot is cell.robots["aux_2"]
    assert cell.guarded_robot("force").robot is cell.robots["main"]
    with pytest.raises(GuardDied):
        cell.health_checks()["force_sensors.force"]()
    cell.workers.close()


async def test_one_device_that_fails_is_named_by_its_own_fault(bench: Bench) -> None:
    bench.cell.aux_1.faults["connect"] = ConnectTimeout("aux_1 on 7011")
    with pytest.raises(ConnectTimeout, match="7011"):
        await bench.cell.connect()
    assert not bench.cell.connected
    assert bench.cell.guard.asked == ["start", "stop"], "the others are let go"
    bench.cell.aux_1.faults.clear()
    await bench.cell.connect()
    assert bench.cell.connected


async def test_all_devices_that_fail_are_named(bench: Bench) -> None:
    bench.cell.aux_1.faults["connect"] = ConnectTimeout("port 7011")
    bench.cell.guard.faults["start"] = GuardDied("no sensor")
    with pytest.raises(ConnectTimeout) as caught:
        await bench.cell.connect()
    assert "robots.aux_1" in caught.value.detail
    assert "force_sensors.force: F510" in caught.value.detail


async def test_a_defect_is_not_taken_for_a_device(bench: Bench) -> None:
    bench.cell.aux_1.faults["connect"] = ValueError("defect")  # type: ignore[assignment]
    with pytest.raises(ValueError, match="defect"):
        await bench.cell.connect()


async def test_stop_reaches_every_robot_though_one_fails(bench: Bench) -> None:
    bench.cell.main.faults["stop"] = StopFailed("main")
    bench.cell.aux_1.faults["stop"] = LinkLost("aux_1")
    with pytest.raises(StopFailed) as caught:
        await bench.cell.stop_motion()
    assert [robot.stops for robot in bench.cell.robots.values()] == [1, 1, 1]
    assert any("F202" in note for note in caught.value.__notes__)
    assert list(bench.cell.unstopped) == ["main", "aux_1"]


async def test_the_guard_of_a_robot_that_stands_is_disarmed_after_it(bench: Bench) -> None:
    bench.cell.aux_1.faults["stop"] = StopFailed("aux_1")
    with pytest.raises(StopFailed):
        await bench.cell.stop_motion()
    assert bench.cell.guard.asked == ["stop_robot", "disarm"]


async def test_the_guard_of_a_robot_that_may_move_stops_it_too_and_stays_armed(
    bench: Bench,
) -> None:
    bench.cell.main.faults["stop"] = StopFailed("main")
    with pytest.raises(StopFailed):
        await bench.cell.stop_motion()
    assert bench.cell.guard.asked == ["stop_robot"]


async def test_the_guard_does_not_wait_for_a_robot_whose_stop_hangs(bench: Bench) -> None:
    hangs = asyncio.Event()

    async def stop() -> None:
        await hangs.wait()

    bench.cell.main.stop = stop  # type: ignore[method-assign]
    stopping = asyncio.create_task(bench.cell.stop_motion())
    async with asyncio.timeout(1.0):
        while "stop_robot" not in bench.cell.guard.asked:  # noqa: ASYNC110  no event for it
            await asyncio.sleep(0)
    assert not stopping.done()
    hangs.set()
    await stopping


async def test_a_robot_without_a_confirmed_stop_counts_as_moving_until_connect(
    bench: Bench,
) -> None:
    bench.cell.main.faults["stop"] = StopFailed("main")
    with pytest.raises(StopFailed):
        await bench.cell.stop_motion()
    bench.cell.main.faults.clear()
    await bench.cell.connect()
    assert not bench.cell.unstopped


async def test_a_driver_that_hangs_in_its_stop_counts_as_moving(bench: Bench) -> None:
    async def stop() -> None:
        await asyncio.Event().wait()

    bench.cell.main.stop = stop  # type: ignore[method-assign]
    bench.cell.aux_1.faults["stop"] = StopFailed("aux_1")
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.05):
            await bench.cell.stop_motion()
    assert list(bench.cell.unstopped) == ["main", "aux_1"]
    assert "disarm" not in bench.cell.guard.asked


async def test_clear_does_not_believe_that_an_arm_stands_which_reports_that_it_moves(
    bench: Bench,
) -> None:
    main = bench.cell.main
    main.faults["stop"] = StopFailed("main")
    with pytest.raises(StopFailed):
        await bench.cell.stop_motion()
    main.faults.clear()
    state = main.state
    main.state = lambda max_age_s=1.0: replace(state(max_age_s), moving=True)  # type: ignore[method-assign]
    with pytest.raises(StopFailed, match="main still moves"):
        await bench.cell.connect()
    assert list(bench.cell.unstopped) == ["main"]
    with pytest.raises(RobotNotReady, match="still moves"):
        require_ready([main])
    main.state = state  # type: ignore[method-assign]
    await bench.cell.connect()
    assert not bench.cell.unstopped


async def test_nothing_is_stopped_that_was_never_connected(bench: Bench) -> None:
    await bench.cell.disconnect()
    await bench.cell.stop_motion()
    assert [robot.stops for robot in bench.cell.robots.values()] == [0, 0, 0]


async def test_a_dead_guard_does_not_keep_the_robots_from_stopping(bench: Bench) -> None:
    bench.cell.guard.faults["disarm"] = GuardDied("killed")
    await bench.cell.stop_motion()
    assert all(robot.latched for robot in bench.cell.robots.values())


async def test_rearm_releases_the_guard_first(bench: Bench) -> None:
    await bench.cell.stop_motion()
    bench.cell.guard.faults["acknowledge"] = GuardDied("killed")
    with pytest.raises(GuardDied):
        await bench.cell.rearm()
    assert all(robot.latched for robot in bench.cell.robots.values())
    bench.cell.guard.faults.clear()
    await bench.cell.rearm()
    assert not any(robot.latched for robot in bench.cell.robots.values())
    assert not any(robot.moves for robot in bench.cell.robots.values())


async def test_disconnecting_skips_nobody(bench: Bench) -> None:
    bench.cell.main.faults["disconnect"] = LinkLost("main")
    await bench.cell.disconnect()
    assert bench.cell.guard.asked == ["stop"]
    with pytest.raises(LinkLost):
        await bench.cell.tracker.serial_number()
