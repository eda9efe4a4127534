"""``python -m benchmarks.cameras.throughput``: pairs a second of a GenTL head.

Beside a bare loop of harvesters on the same fake producer in the same run, turn by turn: two
cameras are triggered, and both images waited for. The bare loop looks at the images where they are;
the driver brings them to another process.
"""

import asyncio
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from cellctl.clock import now_s
from drivers.camera.gige.config import GigeHeadConfig, Selection
from drivers.camera.gige.driver import GigeHead
from fakes.gentl.build import build_producer
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras

SERIALS = ("GL", "GR")
EXPOSURE_S = 0.005
WIDTH, HEIGHT = 2448, 2048


def main(pairs: int = 40, rounds: int = 5) -> None:
    """Alternate rounds of both; prints medians and the ratio."""
    with tempfile.TemporaryDirectory() as folder:
        producer = build_producer(Path(folder))
        cameras = [FakeCamera(serial, width=WIDTH, height=HEIGHT) for serial in SERIALS]
        with FakeCameras(Path(folder) / "cameras", cameras) as fakes:
            os.environ[ENVIRONMENT] = str(fakes.path)
            bare: list[float] = []
            driver: list[float] = []
            for _ in track(range(rounds), "rounds", transient=True):
                bare += _timed_bare(producer, pairs)
                driver += asyncio.run(_timed_driver(producer, pairs))
    _print(np.array(bare), np.array(driver))


def _timed_bare(producer: Path, pairs: int) -> list[float]:
    # Imported here: the standard's libraries are loaded by whoever measures them only.
    from harvesters.core import Harvester

    harvester = Harvester()
    harvester.add_file(str(producer))
    harvester.update()
    cameras = [harvester.create({"serial_number": serial}) for serial in SERIALS]
    for camera in cameras:
        nodes = camera.remote_device.node_map
        nodes.TriggerMode.value, nodes.TriggerSource.value = "On", "Software"
        nodes.ExposureTime.value = EXPOSURE_S * 1e6
        camera.start()
    took = [_took(lambda: _bare_pair(cameras)) for _ in range(pairs)]
    for camera in cameras:
        camera.stop()
        camera.destroy()
    harvester.reset()
    return took


def _bare_pair(cameras: list[Any]) -> None:
    for camera in cameras:
        camera.remote_device.node_map.TriggerSoftware.execute()
    for camera in cameras:
        with camera.fetch(timeout=5.0) as buffer:
            assert buffer.payload.components[0].data.size == WIDTH * HEIGHT


def _took(work: Callable[[], None]) -> float:
    began_s = now_s()
    work()
    return now_s() - began_s


async def _timed_driver(producer: Path, pairs: int) -> list[float]:
    settings = GigeHeadConfig(
        left=Selection(serial_number=SERIALS[0]),
        right=Selection(serial_number=SERIALS[1]),
        producers=(producer,),
        exposure_s=EXPOSURE_S,
        max_difference_s=0.5,
    )
    took: list[float] = []
    async with GigeHead("head", settings) as head:
        await head.grab()
        for _ in range(pairs):
            began_s = now_s()
            await head.grab()
            took.append(now_s() - began_s)
    return took


def _print(bare_s: np.ndarray, driver_s: np.ndarray) -> None:
    table = Table("", "median ms", "p95 ms", "pairs/s", title=f"{WIDTH} x {HEIGHT}, Mono8")
    for name, took_s in (("bare harvesters", bare_s), ("driver gige", driver_s)):
        middle, late = np.percentile(took_s, [50, 95])
        table.add_row(name, f"{middle * 1e3:.1f}", f"{late * 1e3:.1f}", f"{1 / middle:.1f}")
    Console().print(table)
    ratio = float(np.median(bare_s) / np.median(driver_s))
    typer.echo(f"rate of the driver: {ratio:.2f} of bare harvesters")


if __name__ == "__main__":
    typer.run(main)
