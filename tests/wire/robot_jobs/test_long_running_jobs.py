"""Counters of the background jobs that run for weeks: 32 bits are 24 days of milliseconds."""

import asyncio
from collections.abc import AsyncIterator, Callable

import pytest
from scipy.spatial.transform import RigidTransform

from drivers.robot.siasun.codec.records import REPORT_COUNTS, Status
from drivers.robot.siasun.stop_channel import SiasunStopChannel
from tests.rigs.wire.job_rig import JobRig, job_rig

SILENCE_MAX_MS = 1_000_000
CLOCK, COUNT, SILENCE = 304, 309, 303
"""Variables of SJLSTA; those of SJLGRD are a hundred further."""


@pytest.fixture
async def rig() -> AsyncIterator[JobRig]:
    async with job_rig() as rig:
        await rig.connect()
        yield rig


async def reports(rig: JobRig, holds: Callable[[Status], bool] = lambda _: True) -> None:
    await rig.robot._state.wait(holds, 2.0)


async def test_an_arm_moves_on_while_the_counters_begin_anew(rig: JobRig) -> None:
    """Number and time of a report reach their ends in the same motion, and every report is news."""
    numbers = rig.controller.memory.numbers
    counts: list[int] = []
    await reports(rig, lambda status: not status.latched)
    for share in (0.3, 0.6, 0.9):
        numbers["I", COUNT] = int(REPORT_COUNTS * share)
        await reports(rig, lambda status: status.count > REPORT_COUNTS * share)  # noqa: B023
    up = RigidTransform.from_translation([0.0, 0.0, 0.02])
    target = up * rig.robot.state().base_T_flange
    moving = asyncio.create_task(
        rig.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0)
    )
    await reports(rig, lambda status: status.moving)
    numbers["I", COUNT], numbers["I", CLOCK] = REPORT_COUNTS - 4, REPORT_COUNTS - 100

    def noted(status: Status) -> bool:
        counts.append(status.count)
        return status.count == 1

    await reports(rig, noted)
    await moving
    assert counts[-3:] == [REPORT_COUNTS - 1, 0, 1]
    assert numbers["I", CLOCK] < REPORT_COUNTS / 2


async def test_a_pc_that_is_silent_for_weeks_finds_the_job_alive(rig: JobRig) -> None:
    rig.wires["STA"].back.blocked = True
    await reports(rig, lambda status: status.latched)
    numbers = rig.controller.memory.numbers
    numbers["I", SILENCE] = SILENCE_MAX_MS - 10
    begun_ms = numbers["I", CLOCK]
    await reports(rig, lambda status: status.robot_ms > begun_ms + 400)
    # One round may have been added since it was cut back.
    assert SILENCE_MAX_MS <= numbers["I", SILENCE] < SILENCE_MAX_MS + 200
    rig.wires["STA"].back.blocked = False
    await rig.robot.rearm()
    assert numbers["I", SILENCE] < SILENCE_MAX_MS


async def test_the_guard_reads_on() -> None:
    async with job_rig(channels=("CMD", "STA", "GRD")) as rig:
        channel = SiasunStopChannel(rig.guard)
        opening = asyncio.create_task(asyncio.to_thread(channel.open))
        await rig.connect()
        await opening
        numbers = rig.controller.memory.numbers
        try:
            for start in (REPORT_COUNTS * 0.3, REPORT_COUNTS * 0.6, REPORT_COUNTS - 2):
                numbers["I", COUNT + 100] = start
                numbers["I", CLOCK + 100] = REPORT_COUNTS - 2
                for _ in range(4):
                    await news(channel)
        finally:
            channel.close()
        assert numbers["I", COUNT + 100] < 100
        assert rig.controller.alarm == ""


async def news(channel: SiasunStopChannel) -> None:
    async with asyncio.timeout(1.0):
        while channel.poll() is None:  # noqa: ASYNC110  the guard polls
            await asyncio.sleep(0.002)
        channel.heartbeat()
