"""The daemon dies in the worst way: the guard stops the robot and goes."""

import asyncio
import os
import signal
import sys
from pathlib import Path

import pytest

from fakes.wire.sri.box import SriBox
from tests.rigs.waiting import until
from tests.rigs.whole_cell.guard_rig import Robot, noisy
from tests.rigs.wire.ports import free_ports
from tests.rigs.wire.siasun_peer import Peer

ROOT = Path(__file__).parents[3]


async def connected(port: int) -> Peer:
    async with asyncio.timeout(10):
        while True:
            try:
                peer = Peer(*await asyncio.open_connection("127.0.0.1", port))
            except ConnectionRefusedError:
                await asyncio.sleep(0.01)
                continue
            await peer.hello("GRD")
            return peer


@pytest.mark.parametrize(
    "how", [signal.SIGKILL, pytest.param(signal.SIGTERM, marks=pytest.mark.long)]
)
async def test_a_killed_daemon(how: signal.Signals) -> None:
    box = SriBox(lambda time_s: noisy([0.0] * 6))
    sensor_port = await box.start_tcp()
    (guard_port,) = free_ports(1)
    daemon = await asyncio.create_subprocess_exec(
        *(
            sys.executable,
            "-m",
            "tests.rigs.whole_cell.guard_daemon",
            str(sensor_port),
            str(guard_port),
        ),
        stdout=asyncio.subprocess.PIPE,
        cwd=ROOT,
    )
    assert daemon.stdout is not None
    robot = Robot(await connected(guard_port))
    running = asyncio.create_task(robot.run())
    guard_pid = int(await asyncio.wait_for(daemon.stdout.readline(), 10))
    guard = os.pidfd_open(guard_pid)
    gone = asyncio.Event()
    asyncio.get_running_loop().add_reader(guard, gone.set)
    try:
        assert robot.stops_s == []
        daemon.send_signal(how)
        await robot.stopped()
        await asyncio.wait_for(gone.wait(), 2)
        await asyncio.wait_for(robot.lost.wait(), 2)
        await until(lambda: robot.latched)
    finally:
        asyncio.get_running_loop().remove_reader(guard)
        os.close(guard)
        await daemon.wait()
        robot.peer.writer.close()
        await asyncio.gather(running, return_exceptions=True)
        await box.stop()
