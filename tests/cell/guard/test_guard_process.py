"""The guard as a process: what trips it, what it tells, and what happens when somebody dies."""

import asyncio
import os
import signal
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.force import GuardDied, GuardRefused, SensorSetupWrong, SensorSilent
from cellctl.errors.link import ConnectTimeout, LinkLost
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.guard.client import GuardClient
from cellctl.guard.limits import UNLIMITED, CusumTouch, GuardLimits
from cellctl.guard.report import TripReason
from fakes.wire.sri.box import SriBox
from tests.rigs.waiting import until
from tests.rigs.whole_cell.guard_rig import NOTHING, PATIENT, SETTINGS, noisy, rig, tripped
from tests.rigs.wire.ports import free_ports


async def test_it_publishes_and_beats_without_being_armed() -> None:
    async with rig() as cell:
        await until(lambda: len(cell.robot.beats_s) > 20)
        gaps = np.diff(cell.robot.beats_s)
        assert np.median(gaps) == pytest.approx(SETTINGS.beat_s, rel=0.2)
        begin_s = cell.client.latest().time_s
        await until(lambda: cell.client.latest().time_s > begin_s + 0.2)
        curve = cell.client.samples(begin_s)
        assert len(curve.time_s) == pytest.approx(100, abs=25)
        assert not curve.overrun
        health = cell.client.health()
        assert (health.alive, health.armed, health.latched) == (True, False, False)
        assert health.stop_channel_up
        assert health.resident_peak_bytes > 1e6
        assert "M8128B1-FAKE" in health.sensor_serial
        cell.client.check()
        assert cell.robot.stops_s == []


async def test_a_force_stops_the_robot_latches_and_is_reported() -> None:
    async with rig() as cell:
        await cell.client.arm(PATIENT)
        await asyncio.sleep(0.05)
        assert cell.client.trip is None
        cell.force[2] = 30.0
        trip = await tripped(cell.client)
        assert (trip.reason, trip.component) == (TripReason.RAW_LIMIT, 2)
        await cell.robot.stopped()
        cell.force[2] = 0.0
        with pytest.raises(GuardRefused, match="latched"):
            await cell.client.arm(PATIENT)
        assert cell.client.health().latched
        assert cell.client.health().peak_raw[2] > 20.0
        await cell.client.acknowledge()
        assert cell.client.trip is None
        cell.robot.latched = False
        await until(lambda: not cell.client.health().latched)
        await cell.client.arm(replace(PATIENT, touch=CusumTouch()))
        await asyncio.sleep(0.1)
        assert cell.client.trip is None
        cell.force[2] = 12.0
        trip = await tripped(cell.client)
        assert trip.touch
        await cell.robot.stopped(2)


SHORT = GuardLimits(stale_s=0.1, flange_age_s=1.0)
SENSOR_FAULTS = (
    ("silent", SHORT, TripReason.SENSOR_SILENT),
    ("frozen", PATIENT, TripReason.SENSOR_FROZEN),
    ("nan", PATIENT, TripReason.SENSOR_INVALID),
    ("corrupt_every", PATIENT, TripReason.SENSOR_INVALID),
    ("saturated", replace(PATIENT, raw=UNLIMITED), TripReason.SENSOR_SATURATED),
    ("half_open", SHORT, TripReason.SENSOR_SILENT),
)


def has_sample_after(client: GuardClient, time_s: float) -> bool:
    return client.latest().time_s > time_s


async def test_every_fault_of_the_sensor() -> None:
    async with rig(range=(5000.0,) * 3 + (500.0,) * 3) as cell:
        for fault, limits, reason in SENSOR_FAULTS:
            await until(partial(has_sample_after, cell.client, time.monotonic()))
            await cell.client.arm(limits)
            stops = len(cell.robot.stops_s)
            cell.box.faults.inject(fault)
            trip = await tripped(cell.client)
            assert trip.reason is reason, fault
            await cell.robot.stopped(stops + 1)
            cell.box.faults.clear()
            await cell.client.acknowledge()
            cell.robot.latched = False


async def test_a_lost_sensor_link_trips_and_reading_comes_back_by_itself() -> None:
    async with rig(reconnect_s=0.1) as cell:
        await cell.client.arm(GuardLimits(stale_s=0.05, flange_age_s=1.0))
        cell.box.drop_clients()
        trip = await tripped(cell.client)
        assert trip.reason is TripReason.SENSOR_SILENT
        await until(lambda: cell.client.health().sensor.reconnects == 1)
        assert cell.client.trip is trip
        assert cell.client.health().latched


async def test_a_mute_robot_trips_by_the_age_of_its_pose() -> None:
    async with rig() as cell:
        await cell.client.arm(replace(PATIENT, flange_age_s=0.15))
        cell.robot.mute = True
        trip = await tripped(cell.client)
        assert trip.reason is TripReason.FLANGE_STALE
        await cell.robot.stopped()


async def test_a_lost_stop_channel_trips_and_arming_is_refused() -> None:
    async with rig() as cell:
        await cell.client.arm(PATIENT)
        cell.robot.peer.writer.close()
        trip = await tripped(cell.client)
        assert trip.reason is TripReason.STOP_CHANNEL_LOST
        await cell.client.acknowledge()
        with pytest.raises(GuardRefused, match="stop channel"):
            await cell.client.arm(PATIENT)
        with pytest.raises(LinkLost, match="stop channel"):
            cell.client.check()


async def test_an_ignored_stop_is_repeated_and_then_the_beats_end() -> None:
    async with rig() as cell:
        cell.robot.deaf = 1
        await cell.client.arm(PATIENT)
        cell.force[0] = 30.0
        await cell.robot.stopped(2)
        await until(lambda: cell.robot.latched)
        assert cell.robot.stops_s[1] - cell.robot.stops_s[0] < 0.3

        cell.force[0] = 0.0
        await cell.client.acknowledge()
        cell.robot.latched, cell.robot.deaf = False, 10**6
        await until(lambda: cell.client.health().flange_age_s < 0.1)
        before = len(cell.robot.stops_s)
        await cell.client.arm(PATIENT)
        cell.force[0] = 30.0
        await cell.robot.stopped(before + 20)
        late_s = cell.robot.beats_s[-1] - cell.robot.stops_s[before]
        assert late_s < SETTINGS.stop_confirm_s + 0.15


async def test_a_stop_that_the_daemon_asks_for_goes_out_on_the_guards_own_channel() -> None:
    async with rig() as cell:
        cell.robot.deaf = 1_000_000
        await cell.client.arm(PATIENT)
        await cell.client.stop_robot()
        await cell.robot.stopped(10)
        await asyncio.sleep(0.15)
        beats = len(cell.robot.beats_s)
        await asyncio.sleep(0.1)
        assert len(cell.robot.beats_s) == beats, "no sign of life while the stop is not confirmed"
        assert cell.client.health().armed
        assert cell.client.trip is None
        cell.robot.deaf = 0
        await until(lambda: cell.robot.latched)
        await cell.client.acknowledge()
        await until(lambda: len(cell.robot.beats_s) > beats)


async def test_the_death_of_the_guard_is_told_and_the_beats_end() -> None:
    async with rig() as cell:
        taring = asyncio.create_task(cell.client.tare(5.0))
        await cell.client.set_gravity_compensation(
            NOTHING
        )  # its answer says that the tare was heard
        os.kill(cell.client.pid, signal.SIGKILL)
        trip = await tripped(cell.client)
        with pytest.raises(GuardDied):
            await asyncio.wait_for(taring, 2)
        assert trip.reason is TripReason.GUARD_DIED
        assert "signal 9" in trip.detail
        await asyncio.wait_for(cell.robot.lost.wait(), 2)
        assert isinstance(trip.fault(), GuardDied)
        assert not cell.client.health().alive
        with pytest.raises(GuardDied):
            await cell.client.arm(PATIENT)
        with pytest.raises(GuardDied):
            cell.client.latest()
        with pytest.raises(GuardDied):
            cell.client.check()


async def test_a_hung_guard_is_noticed() -> None:
    async with rig() as cell:
        os.kill(cell.client.pid, signal.SIGSTOP)
        beats = len(cell.robot.beats_s)
        await until(lambda: not cell.client.health().alive, 3.0)
        assert len(cell.robot.beats_s) <= beats + 2
        with pytest.raises(GuardDied, match="old"):
            cell.client.check()


async def test_ctrl_c_is_not_for_the_guard_but_sigterm_is() -> None:
    async with rig() as cell:
        os.kill(cell.client.pid, signal.SIGINT)
        begin_s = time.monotonic()
        await until(lambda: cell.client.latest().time_s > begin_s + 0.1)
        assert cell.robot.stops_s == []
        os.kill(cell.client.pid, signal.SIGTERM)
        await cell.robot.stopped()
        await asyncio.wait_for(cell.robot.lost.wait(), 2)


async def test_an_ordinary_end_stops_the_robot_too() -> None:
    async with rig() as cell:
        await cell.client.stop()
        await cell.robot.stopped()
        assert cell.client.trip is None
        await cell.client.stop()


async def test_tare_and_deck_frame() -> None:
    async with rig() as cell:
        cell.force[2] = -100.0
        load = GravityCompensation(
            np.vstack([np.diag([100.0] * 3), np.zeros((3, 3))]), np.zeros(6), "x"
        )
        await cell.client.set_gravity_compensation(load)
        turned = RigidTransform.from_translation([0.1, 0.0, 0.0])
        assert not cell.client.in_part_frame
        await cell.client.set_wrench_frame(RigidTransform.identity())
        assert cell.client.in_part_frame, "a part may lie in the sensor's axes"
        await cell.client.set_wrench_frame(None)
        assert not cell.client.in_part_frame
        await cell.client.set_wrench_frame(turned)
        assert cell.client.hidden_axial_n is None
        tare = await cell.client.tare(0.1, hides_axial_n=-25.0)
        assert cell.client.hidden_axial_n == -25.0
        # The scripted robot's flange looks down (C = 180°): gravity is +z of the sensor.
        assert tare.mean[2] == pytest.approx(-200.0, abs=0.5)
        assert tare.mean[4] == pytest.approx(-0.1 * 200.0, abs=0.5)
        assert tare.sigma[2] == pytest.approx(0.2, rel=0.5)
        begin_s = cell.client.latest().time_s
        await until(lambda: cell.client.latest().time_s > begin_s + 0.1)
        assert cell.client.samples(begin_s).wrench.mean(axis=0) == pytest.approx([0] * 6, abs=0.2)

        cell.box.faults.inject("silent")
        with pytest.raises(GuardRefused, match="no samples"):
            await cell.client.tare(0.05)
        await until(lambda: cell.client.health().sample_age_s > 1.0)
        with pytest.raises(SensorSilent):
            cell.client.check()
        with pytest.raises(GuardRefused, match="old"):
            await cell.client.arm(replace(PATIENT, stale_s=0.05))


async def test_a_new_guard_after_death_or_hang_knows_load_and_frame_but_is_not_armed() -> None:
    box = SriBox(lambda time_s: [5.0] * 6)
    sensor = {"transport": "tcp", "host": "127.0.0.1", "port": await box.start_tcp()}
    client = GuardClient("sri", sensor, None, None, SETTINGS)
    await client.start()
    offset = GravityCompensation(np.zeros((6, 3)), np.full(6, 2.0), "affine24")
    await client.set_gravity_compensation(offset)
    for end, noticed in (
        (signal.SIGKILL, lambda: client.trip is not None),
        (signal.SIGSTOP, lambda: not client.health().alive),
    ):
        first = client.pid
        os.kill(first, end)
        await until(noticed, 3.0)
        await client.acknowledge()
        assert client.pid not in (0, first)
        assert client.trip is None
    begin_s = time.monotonic()
    await until(lambda: (s := client.newest()) is not None and s.time_s > begin_s)
    assert client.latest().wrench == pytest.approx([3.0] * 6, rel=1e-3)
    assert not client.health().armed
    await client.stop()
    await box.stop()


async def test_a_load_that_hangs_needs_a_stop_channel() -> None:
    box = SriBox(lambda time_s: [0.0] * 6)
    sensor = {"transport": "tcp", "host": "127.0.0.1", "port": await box.start_tcp()}
    client = GuardClient("sri", sensor, None, None, SETTINGS)
    await client.start()
    with pytest.raises(GuardRefused, match="compensation"):
        await client.arm(PATIENT)
    with pytest.raises(GuardRefused, match="stop channel"):
        await client.set_gravity_compensation(
            GravityCompensation(np.ones((6, 3)), np.zeros(6), "affine24")
        )
    await client.set_gravity_compensation(NOTHING)
    await client.stop()
    await box.stop()


async def test_a_sensor_that_is_not_there() -> None:
    (port,) = free_ports(1)
    sensor = {"transport": "tcp", "host": "127.0.0.1", "port": port}
    client = GuardClient("sri", sensor, None, None, SETTINGS)
    with pytest.raises(ConnectTimeout, match=str(port)):
        await client.start()
    assert (client.running, client.trip) == (False, None)
    await client.stop()


async def test_a_sensor_that_is_set_wrongly() -> None:
    box = SriBox(lambda time_s: [0.0] * 6)
    box.settings.raw_unit = "MV"
    sensor = {"transport": "tcp", "host": "127.0.0.1", "port": await box.start_tcp()}
    client = GuardClient("sri", sensor, None, None, SETTINGS)
    with pytest.raises(SensorSetupWrong, match="DCPCU"):
        await client.start()
    await box.stop()


async def test_a_robot_that_does_not_come() -> None:
    box = SriBox(lambda time_s: [0.0] * 6)
    sensor = {"transport": "tcp", "host": "127.0.0.1", "port": await box.start_tcp()}
    (port,) = free_ports(1)
    stop = {"robot_name": "SR500A", "guard_port": port, "connect_timeout_s": 0.2}
    client = GuardClient("sri", sensor, "siasun-sjl", stop, SETTINGS)
    with pytest.raises(ConnectTimeout, match="SR500A"):
        await client.start()
    assert not client.running
    await box.stop()


async def test_a_box_that_comes_back_with_another_set_up_is_named_until_it_is_put_right() -> None:
    box = SriBox(lambda time_s: noisy([0.0] * 6))
    port = await box.start_tcp()
    sensor = {"transport": "tcp", "host": "127.0.0.1", "port": port, "reconnect_s": 0.1}
    client = GuardClient("sri", sensor, None, None, SETTINGS)
    await client.start()
    await client.set_gravity_compensation(NOTHING)
    box.settings.raw_unit = "MV"
    box.drop_clients()

    def named() -> bool:
        # That the sensor is shut stands in shared memory, a moment before the guard's word why.
        try:
            client.check()
        except SensorSetupWrong:
            return True
        except SensorSilent:
            pass
        return False

    await until(named)
    for _ in range(2):
        with pytest.raises(SensorSetupWrong, match="DCPCU"):
            client.check()
        with pytest.raises(SensorSetupWrong, match="DCPCU"):
            await client.acknowledge()
    box.settings.raw_unit = "MVPV"
    await client.acknowledge()
    client.check()
    await client.tare(0.05)
    await client.arm(PATIENT)
    await client.stop()
    await box.stop()


async def test_a_hung_guard_is_killed_also_when_the_wait_for_its_end_is_given_up() -> None:
    async with rig() as r:
        pid = r.client.pid
        os.kill(pid, signal.SIGSTOP)
        ending = asyncio.create_task(r.client.stop())
        await asyncio.sleep(0.05)
        ending.cancel()
        await asyncio.gather(ending, return_exceptions=True)
        await until(lambda: not Path(f"/proc/{pid}").exists())
