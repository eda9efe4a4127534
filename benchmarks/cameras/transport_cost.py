"""``python -m benchmarks.cameras.transport_cost``: what a pair of the fake cell costs on each way.

A whole fake cell renders for a head that stands still, behind a frame server and behind the fake
GenTL producer, turn by turn. Both of its processes, the driver and the maker's library count.
"""

import asyncio
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from cellctl.clock import now_s
from cellctl.interfaces.stereo_camera import StereoCamera
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.driver import FrameServerHead
from drivers.camera.gige.config import GigeHeadConfig, Selection
from drivers.camera.gige.driver import GigeHead
from fakes.gentl.build import build_producer
from fakes.gentl.cameras import ENVIRONMENT
from fakes.scenes.deck_on_frame.scenario import DeckScenario

SCENARIO = Path(__file__).parents[2] / "config" / "deck.scenario.toml"
HEAD = "head_1"
PATIENCE_S = 60.0
Way = Literal["frame server", "GenTL"]


@dataclass
class Cost:
    """What all pairs of one way cost."""

    took_s: list[float] = field(default_factory=list)
    processor_s: list[float] = field(default_factory=list)
    """Processor time of all processes together: the mean of each round."""


def main(pairs: int = 12, rounds: int = 3) -> None:
    """Alternate rounds of both; prints medians."""
    costs: dict[Way, Cost] = {"frame server": Cost(), "GenTL": Cost()}
    with tempfile.TemporaryDirectory() as folder:
        producer = build_producer(Path(folder))
        os.environ[ENVIRONMENT] = str(Path(folder, "cameras"))
        for _ in range(rounds):
            for way, cost in costs.items():
                asyncio.run(_measure(way, producer, pairs, cost))
    _print(costs)


async def _measure(way: Way, producer: Path, pairs: int, cost: Cost) -> None:
    async with _head(way, producer) as head:
        await head.grab()  # the scene is rendered once, and kept
        begun_s, processor_s = now_s(), _processor_s()
        for _ in range(pairs):
            began_s = now_s()
            await head.grab()
            cost.took_s.append(now_s() - began_s)
        passed_s, used_s = now_s() - begun_s, _processor_s() - processor_s
        # The world takes its share without any image too.
        processor_s = _processor_s()
        await asyncio.sleep(passed_s)
        cost.processor_s.append((used_s - (_processor_s() - processor_s)) / pairs)


@asynccontextmanager
async def _head(way: Way, producer: Path) -> AsyncIterator[StereoCamera]:
    scenario = DeckScenario.read(SCENARIO)
    command = [sys.executable, "-m", "fakes", "run", "--scenario", str(SCENARIO)]
    listening = [name for name in scenario.ports() if "." not in name]
    command += [word for name in listening for word in ("--port", f"{name}=0")]
    if way == "GenTL":
        command += ["--gentl", os.environ[ENVIRONMENT]]
    cell = await asyncio.create_subprocess_exec(*command, stdout=subprocess.PIPE)
    try:
        assert cell.stdout is not None
        ready: dict[str, Any] = json.loads(await cell.stdout.readline())
        async with _driver(way, producer, scenario, ready["ports"]) as head:
            yield head
    finally:
        cell.terminate()
        await cell.wait()


def _driver(
    way: Way, producer: Path, scenario: DeckScenario, ports: dict[str, int]
) -> FrameServerHead | GigeHead:
    if way == "frame server":
        settings = FrameServerConfig(host="127.0.0.1", port=ports[HEAD], reply_timeout_s=PATIENCE_S)
        return FrameServerHead(HEAD, settings)
    left, right = scenario.stereo_cameras[HEAD].serials
    return GigeHead(
        HEAD,
        GigeHeadConfig(
            left=Selection(serial_number=left),
            right=Selection(serial_number=right),
            producers=(producer,),
            exposure_s=scenario.optics_of(HEAD).exposure_us / 1e6,
            image_timeout_s=PATIENCE_S,
            max_difference_s=0.5,
        ),
    )


def _processor_s() -> float:
    """Time that this process and all its descendants have had a processor so far."""
    used: dict[int, float] = {}
    parents: dict[int, int] = {}
    for folder in Path("/proc").iterdir():
        try:
            words = (folder / "stat").read_text(encoding="ascii").rpartition(")")[2].split()
        except (OSError, UnicodeDecodeError):
            continue  # ended meanwhile, or no process
        if folder.name.isdigit():
            parents[int(folder.name)] = int(words[1])
            used[int(folder.name)] = (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    def own(process: int) -> float:
        children = [child for child, parent in parents.items() if parent == process]
        return used[process] + sum(map(own, children))

    return own(os.getpid())


def _print(costs: dict[Way, Cost]) -> None:
    table = Table("", "median ms", "95 % within ms", "processor ms", title="a pair of 5 megapixels")
    for way, cost in costs.items():
        middle, late = np.percentile(cost.took_s, [50, 95]) * 1e3
        processor = float(np.median(cost.processor_s)) * 1e3
        table.add_row(way, f"{middle:.0f}", f"{late:.0f}", f"{processor:.0f}")
    Console().print(table)


if __name__ == "__main__":
    typer.run(main)
