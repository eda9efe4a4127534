"""What is compared: the guard process, and a baseline with everything in one process.

The baseline uses the same codec, sampler and monitor as the guard, on asyncio, with the work in
threads: the straightforward way to write such a controller (docs/decisions/0003).
"""

import asyncio
import multiprocessing
import os
import threading
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from benchmarks.guard import loads
from cellctl import log
from cellctl.clock import now_s
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.geometry.euler_order import EulerOrder
from cellctl.guard.client import GuardClient
from cellctl.guard.limits import CusumTouch, GuardLimits, GuardSettings
from cellctl.guard.watch.monitor import WrenchMonitor
from cellctl.interfaces.ft_sensor import FtHealth
from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.protocol import Frame, StreamDecoder, command
from drivers.ftsensor.sri.sampler import Sampler
from drivers.robot.siasun import protocol as sjl
from drivers.robot.siasun.codec import decoder
from drivers.robot.siasun.codec.records import Status
from drivers.robot.siasun.stop_channel import flange_state

GUARD_MODULE = "benchmarks.guard.child"
ROOT = Path(__file__).parents[2]
RATE_HZ = 1000
SESSION = 1
HOUSEKEEPING_S = 0.01
SETTLE_S = 1.5
LIMITS = GuardLimits(
    raw=(1e3,) * 6,
    filtered=(1e3,) * 6,
    touch=CusumTouch(drift_n=15.0, threshold_n=0.0),
    stale_s=30.0,
    flange_age_s=30.0,
    bad_frames=1000,
)
"""Every detector runs; each sample with the force on is a touch of its own."""


def loads_of(kind: str) -> tuple[int, list[Any]]:
    """Vision workers that run flat out, and what the daemon's own process does."""
    own = [loads.events] if kind != "idle" else []
    if kind == "gil":
        own.append(loads.bomb)
    return (0 if kind == "idle" else 2), own


def show_benchmarks_to_programs() -> None:
    """Have the programs that this process starts find the benchmarks.

    A guard takes its modules from the installation alone, and these belong to none.
    """
    os.environ["PYTHONPATH"] = str(ROOT)


def guard_process(pipe: Connection, sensor_port: int, guard_port: int, load: str) -> None:
    """The daemon with its guard; its vision workers are processes, as in the product."""
    asyncio.run(_guard_process(pipe, sensor_port, guard_port, load))


def plain(pipe: Connection, sensor_port: int, guard_port: int, load: str) -> None:
    """asyncio for the devices and threads for the work, in one process."""
    asyncio.run(_plain(pipe, sensor_port, guard_port, load))


async def _guard_process(pipe: Connection, sensor_port: int, guard_port: int, load: str) -> None:
    log.configure(level=log.LogLevel.ERROR)  # each of the thousand trips a second is a warning
    show_benchmarks_to_programs()
    tcp = {"transport": "tcp", "host": "127.0.0.1", "port": sensor_port, "rate_hz": RATE_HZ}
    sjl_grd = {"robot_name": "SR500A", "guard_port": guard_port}
    settings = GuardSettings()
    client = GuardClient("sri", tcp, "siasun-sjl", sjl_grd, settings, module=GUARD_MODULE)
    await client.start()
    await client.set_gravity_compensation(GravityCompensation.none())
    async with asyncio.timeout(20):
        while client.health().flange_age_s > 1.0:  # noqa: ASYNC110 - lies in another process
            await asyncio.sleep(HOUSEKEEPING_S)
    workers, own = loads_of(load)
    stop = threading.Event()
    threads = loads.threads(own, stop)
    context = multiprocessing.get_context("spawn")
    ends = context.Event()
    pool = [context.Process(target=loads.vision, args=(ends.is_set,)) for _ in range(workers)]
    for worker in pool:
        worker.start()
    await asyncio.sleep(SETTLE_S)
    await client.arm(LIMITS)
    pipe.send(", ".join(client.health().degraded))
    while not pipe.poll():
        await asyncio.sleep(HOUSEKEEPING_S)
        client.newest()
    ends.set()
    stop.set()
    for thread in threads:
        thread.join(10)
    for worker in pool:
        worker.join(10)
    await client.stop()


async def _plain(pipe: Connection, sensor_port: int, guard_port: int, load: str) -> None:
    robot: asyncio.Future[tuple[asyncio.StreamReader, asyncio.StreamWriter]]
    robot = asyncio.get_running_loop().create_future()
    server = await asyncio.start_server(
        lambda reader, writer: robot.set_result((reader, writer)), "127.0.0.1", guard_port
    )
    reader, writer = await asyncio.wait_for(robot, 20)
    await asyncio.wait_for(reader.readline(), 5)
    writer.write(sjl.accept_hello(SESSION))
    monitor = WrenchMonitor((1, 0, 0, 0, 1, 0, 0, 0, 1), has_channel=True)
    monitor.channel_up = True
    monitor.contact.set_gravity_compensation([(0.0,) * 3] * 6, (0.0,) * 6, (0.0, 0.0, -1.0))
    reporting = asyncio.create_task(_reports(reader, monitor))
    sensing = asyncio.create_task(_sense(sensor_port, monitor, writer))
    async with asyncio.timeout(20):
        while min(monitor.sample_time_s, monitor.flange_time_s) < 0.0:  # noqa: ASYNC110 - set by the tasks
            await asyncio.sleep(HOUSEKEEPING_S)
    workers, own = loads_of(load)
    stop = threading.Event()
    threads = loads.threads([loads.vision] * workers + own, stop)
    await asyncio.sleep(SETTLE_S)
    monitor.arm(LIMITS, FtHealth(), now_s())
    pipe.send("")
    beats = 0
    while not pipe.poll():
        await asyncio.sleep(HOUSEKEEPING_S)
        beats += 1
        writer.write(sjl.beat(SESSION, beats))
    stop.set()
    for thread in threads:
        thread.join(10)
    for task in (reporting, sensing):
        task.cancel()
    await asyncio.gather(reporting, sensing, return_exceptions=True)
    writer.close()
    server.close()


async def _reports(reader: asyncio.StreamReader, monitor: WrenchMonitor) -> None:
    while line := await reader.readline():
        record = decoder.decode(line.rstrip(b"\n"))
        if isinstance(record, Status):
            monitor.flange(flange_state(record, EulerOrder.FIXED_XYZ, now_s()))


async def _sense(port: int, monitor: WrenchMonitor, robot: asyncio.StreamWriter) -> None:
    """The same codec, sampler and monitor as in the guard, on asyncio's streams."""
    config = SriConfig(transport="tcp", rate_hz=RATE_HZ)
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    for words in (("GSD", "STOP"), ("SMPF", str(RATE_HZ)), ("GSD", None)):
        writer.write(command(*words))
    decoder, sampler = StreamDecoder(config.layout), Sampler(config)
    stops = 0
    while data := await reader.read(65_536):
        frames = [item for item in decoder.feed(data) if isinstance(item, Frame)]
        for sample in sampler.take(frames, now_s()):
            monitor.sample(sample)
            if monitor.trip is not None:
                stops += 1
                robot.write(sjl.abort(SESSION, stops))
                monitor.trip = None
