"""``make bench-cameras``: pairs a second of a GenTL head, beside a bare loop of harvesters.

Both use the same fake producer in the same run, turn by turn: two cameras are triggered, and both
images waited for. The bare loop looks at the images where they are; the driver brings them to
another process. Once with images that take the time of a line of 1 Gbit/s for each camera, and once
as fast as memory is, which no camera is. Exit code 1 when the driver comes below 0.95 of the rate
of the bare loop at the speed of the line.
"""

import asyncio
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from cellctl.clock import now_s
from drivers.camera.gige.config import GigeHeadConfig, Selection
from drivers.camera.gige.driver import GigeHead
from fakes.gentl.build import build_producer
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras

LEAST_RATIO = 0.95
OF_DRIVER, OF_BARE = ("DL", "DR"), ("BL", "BR")
"""Serial numbers: each has a pair of cameras of its own, open through the whole run."""
EXPOSURE_S = 0.005
WIDTH, HEIGHT = 2448, 2048
LINE_MS = 42
"""What such an image takes in packets of 8000 bytes at 1 Gbit/s."""
_DRAWS = 4000
_COVERED = (2.5, 97.5)
"""Percentiles between which the true median ratio lies in 95 of 100 runs, by resampling."""


@dataclass(frozen=True, slots=True)
class Timed:
    """Pairs of one contender."""

    took_s: list[list[float]] = field(default_factory=list)
    """Times from the trigger to both images, one list a round."""
    late_s: list[float] = field(default_factory=list)
    """Times from the end of the last exposure until the caller has both images."""

    def medians_s(self) -> NDArray[np.float64]:
        """Median of each round."""
        return np.array([np.median(one) for one in self.took_s])


def main(pairs: int = 20, rounds: int = 20) -> None:
    """Alternate rounds of both; prints medians, and the ratio with its interval."""
    by_line = _race(pairs, rounds, LINE_MS)
    _race(pairs, rounds, 0)
    if by_line < LEAST_RATIO:
        raise typer.Exit(1)


def _race(pairs: int, rounds: int, line_ms: int) -> float:
    """The ratio of both rates, for images that take so long on their line."""
    bare, driver = Timed(), Timed()
    with tempfile.TemporaryDirectory() as folder:
        producer = build_producer(Path(folder))
        cameras = [FakeCamera(one, width=WIDTH, height=HEIGHT) for one in (*OF_DRIVER, *OF_BARE)]
        with FakeCameras(Path(folder) / "cameras", cameras) as fakes:
            os.environ[ENVIRONMENT] = str(fakes.path)
            for one in cameras:
                fakes.inject(one.serial, "slow_ms", line_ms)
            asyncio.run(_raced(producer, pairs, rounds, bare, driver))
    _print(bare, driver, line_ms)
    ratios = bare.medians_s() / driver.medians_s()
    drawn = np.random.default_rng(1).choice(ratios, (_DRAWS, len(ratios)))
    low, high = np.percentile(np.median(drawn, axis=1), _COVERED)
    middle = float(np.median(ratios))
    typer.echo(
        f"rate of the driver: {middle:.3f} of bare harvesters, 95 % within {low:.3f} to {high:.3f}"
    )
    return middle


async def _raced(producer: Path, pairs: int, rounds: int, bare: Timed, driver: Timed) -> None:
    settings = GigeHeadConfig(
        left=Selection(serial_number=OF_DRIVER[0]),
        right=Selection(serial_number=OF_DRIVER[1]),
        producers=(producer,),
        exposure_s=EXPOSURE_S,
        max_difference_s=2.0,
    )
    async with GigeHead("head", settings) as head:
        with _bare_cameras(producer) as cameras:
            for number in track(range(rounds), "rounds", transient=True):
                # The first of a round finds the caches as the second of the last one left them.
                for contender in (0, 1) if number % 2 else (1, 0):
                    if contender:
                        await _driver_round(head, pairs, driver)
                    else:
                        _bare_round(cameras, pairs, bare)


async def _driver_round(head: GigeHead, pairs: int, timed: Timed) -> None:
    took_s: list[float] = []
    await head.grab()
    for _ in range(pairs):
        began_s = now_s()
        pair = await head.grab()
        ended_s = now_s()
        took_s.append(ended_s - began_s)
        # The fake stamps the end of an exposure with the clock of this PC.
        exposed_ns = max(one.device_time_ns or 0 for one in pair.exposures)
        timed.late_s.append(ended_s - exposed_ns * 1e-9)
    timed.took_s.append(took_s)


@contextmanager
def _bare_cameras(producer: Path) -> Iterator[list[Any]]:
    # Imported here: the standard's libraries are loaded by whoever measures them only.
    from harvesters.core import Harvester

    harvester = Harvester()
    harvester.add_file(str(producer))
    harvester.update()
    cameras = [harvester.create({"serial_number": serial}) for serial in OF_BARE]
    for camera in cameras:
        nodes = camera.remote_device.node_map
        nodes.TriggerMode.value, nodes.TriggerSource.value = "On", "Software"
        nodes.ExposureTime.value = EXPOSURE_S * 1e6
        camera.start()
    yield cameras
    for camera in cameras:
        camera.stop()
        camera.destroy()
    harvester.reset()


def _bare_round(cameras: list[Any], pairs: int, timed: Timed) -> None:
    took_s: list[float] = []
    _bare_pair(cameras)
    for _ in range(pairs):
        began_s = now_s()
        exposed_s = _bare_pair(cameras)
        ended_s = now_s()
        took_s.append(ended_s - began_s)
        timed.late_s.append(ended_s - exposed_s)
    timed.took_s.append(took_s)


def _bare_pair(cameras: list[Any]) -> float:
    """Both images; when the later exposure ended."""
    exposed_ns = 0
    for camera in cameras:
        camera.remote_device.node_map.TriggerSoftware.execute()
    for camera in cameras:
        with camera.fetch(timeout=5.0) as buffer:
            assert buffer.payload.components[0].data.size == WIDTH * HEIGHT
            exposed_ns = max(exposed_ns, buffer.timestamp_ns)
    return exposed_ns * 1e-9


def _print(bare: Timed, driver: Timed, line_ms: int) -> None:
    table = Table(
        "",
        "median ms",
        "95 % within ms",
        "pairs/s",
        "latency ms",
        title=f"{WIDTH} x {HEIGHT}, Mono8, {line_ms} ms on the line",
    )
    for name, timed in (("bare harvesters", bare), ("driver gige", driver)):
        middle, late = np.percentile(np.concatenate(timed.took_s), [50, 95])
        table.add_row(
            name,
            f"{middle * 1e3:.1f}",
            f"{late * 1e3:.1f}",
            f"{1 / middle:.1f}",
            f"{np.median(timed.late_s) * 1e3:.2f}",
        )
    Console().print(table)
    added_ms = (np.median(driver.late_s) - np.median(bare.late_s)) * 1e3
    typer.echo(f"added latency: {added_ms:.2f} ms, from the end of the exposure to both images")


if __name__ == "__main__":
    typer.run(main)
