"""``make soak-cameras``: openings, cable pulls and images in great numbers, and what they leave.

Through the driver, harvesters and genicam with the fake producer. Exit code 1 when descriptors or
threads are kept, or memory grows. The numbers of a short run are options: ``--cycles 20``.
"""

import asyncio
import os
import tempfile
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from cellctl.clock import now_s
from cellctl.errors.link import LinkError
from drivers.camera.gige.config import GigeCameraConfig, Selection
from drivers.camera.gige.driver import GigeCamera
from fakes.gentl.build import build_producer
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras
from tests.rigs.kept import Kept, kept

SERIAL = "GL"
_SETTLE_S = 3.0
_WARM_UP = 0.1
"""Share of a job after which it is looked at for the first time; at least three times."""


@dataclass(frozen=True, slots=True)
class Soaked:
    """One job done many times."""

    name: str
    times: int
    took_s: float
    daemon: tuple[Kept, Kept]
    """What it keeps after the warm-up, and at the end."""
    library: tuple[Kept, Kept] | None
    """The same of the library's process, where one lasted through the job."""
    left: str
    """What the camera says is left open; empty for nothing."""

    @property
    def clean(self) -> bool:
        """Whether nothing was kept."""
        both = [self.daemon, *([self.library] if self.library else [])]
        return not self.left and not any(after.outgrows(before) for before, after in both)


def main(cycles: int = 500, pulls: int = 100, grabs: int = 10_000) -> None:
    """Each job as often as is said."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        producer = build_producer(folder)
        cameras = [FakeCamera(SERIAL, width=640, height=480)]
        with FakeCameras(folder / "cameras", cameras) as fakes:
            os.environ[ENVIRONMENT] = str(fakes.path)
            done = asyncio.run(_all(producer, fakes, cycles, pulls, grabs))
    _print(done)
    if not all(one.clean for one in done):
        raise typer.Exit(1)


async def _all(
    producer: Path, fakes: FakeCameras, cycles: int, pulls: int, grabs: int
) -> list[Soaked]:
    done: list[Soaked] = []
    jobs = ((soak_openings, cycles), (soak_pulls, pulls), (soak_grabs, grabs))
    for job, times in jobs:
        done.append(await job(producer, fakes, times))
        # Said at once: the whole takes long, and a run that is ended early has its figures too.
        typer.echo(done[-1])
    return done


async def soak_openings(producer: Path, fakes: FakeCameras, times: int) -> Soaked:
    """Open, one image, close."""
    _use_one_thread()

    async def once() -> None:
        async with _camera(producer) as camera:
            await camera.grab()

    return await _soaked("open, grab, close", times, once, fakes)


async def soak_pulls(producer: Path, fakes: FakeCameras, times: int) -> Soaked:
    """An image, the cable is pulled, the next image is a fault, the cable is put in again."""
    _use_one_thread()
    async with _camera(producer) as camera:

        async def once() -> None:
            await camera.grab()  # which opens the camera anew, after the first
            fakes.inject(SERIAL, "lost")
            try:
                await camera.grab()
            except LinkError:
                pass
            else:
                raise AssertionError("an image came through a pulled cable")
            fakes.inject(SERIAL, "lost", 0)

        return await _soaked("cable pulls", times, once, fakes)


async def soak_grabs(producer: Path, fakes: FakeCameras, times: int) -> Soaked:
    """Images of one camera that stays open."""
    _use_one_thread()
    async with _camera(producer) as camera:
        last = 0

        async def once() -> None:
            nonlocal last
            image = await camera.grab()
            assert image.frame_id == last + 1
            last = image.frame_id

        return await _soaked("images", times, once, fakes, fakes.opened(SERIAL))


async def _soaked(
    name: str,
    times: int,
    once: Callable[[], Awaitable[None]],
    fakes: FakeCameras,
    library: int = 0,
) -> Soaked:
    began_s = now_s()
    warm = max(3, round(_WARM_UP * times))
    for _ in track(range(warm), name, transient=True):
        await once()
    before = _kept(library)
    for _ in track(range(times - warm), name, transient=True):
        await once()
    after = await _settled(library, before)
    busy = not library and (fakes.opened(SERIAL), fakes.buffers(SERIAL)) != (0, 0)
    left = "the camera is still open" if busy else ""
    of_library = None if not library else (before[1], after[1])
    return Soaked(name, times, now_s() - began_s, (before[0], after[0]), of_library, left)


def _use_one_thread() -> None:
    """A pool that is still growing would look like threads that are kept."""
    # This comes before a camera is opened: its process ends with the thread that has started it.
    asyncio.get_running_loop().set_default_executor(ThreadPoolExecutor(max_workers=1))


def _kept(library: int) -> tuple[Kept, Kept]:
    """What this process and the library's keep; the same twice where none lasts."""
    return kept(os.getpid()), kept(library or os.getpid())


async def _settled(library: int, before: tuple[Kept, Kept]) -> tuple[Kept, Kept]:
    """What is kept once threads that are about to end have ended; what stays is shown at the end.

    A progress bar and the reader of a process that has just been let go do not end at once.
    """
    end_s = now_s() + _SETTLE_S
    while True:
        after = _kept(library)
        grown = any(now.outgrows(then) for now, then in zip(after, before, strict=True))
        if not grown or now_s() > end_s:
            return after
        await asyncio.sleep(0.05)


def _camera(producer: Path) -> GigeCamera:
    settings = GigeCameraConfig(
        camera=Selection(serial_number=SERIAL),
        producers=(producer,),
        exposure_s=0.001,
        image_timeout_s=20.0,
    )
    return GigeCamera("eye", settings)


def _print(done: list[Soaked]) -> None:
    table = Table("job", "times", "took s", "process", "descriptors", "threads", "memory MB", "")
    for one in done:
        rows = [("daemon", one.daemon), *([("library", one.library)] if one.library else [])]
        for number, (process, pair) in enumerate(rows):
            head = (one.name, str(one.times), f"{one.took_s:.0f}") if number == 0 else ("", "", "")
            said = one.left or ("flat" if not pair[1].outgrows(pair[0]) else "GROWS")
            table.add_row(*head, process, *_changes(*pair), said)
    Console().print(table)


def _changes(before: Kept, after: Kept) -> tuple[str, str, str]:
    return (
        f"{before.descriptors} → {after.descriptors}",
        f"{before.threads} → {after.threads}",
        f"{before.memory_kb / 1e3:.1f} → {after.memory_kb / 1e3:.1f}",
    )


if __name__ == "__main__":
    typer.run(main)
