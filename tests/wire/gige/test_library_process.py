"""The process of the maker's library: how it ends, and what its end costs the daemon."""

import asyncio
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from cellctl.errors.link import LinkLost, ReplyTimeout
from fakes.gentl.cameras import FakeCameras
from tests.rigs.waiting import until, until_blocking
from tests.wire.gige.conftest import LEFT, camera, ended

NEVER_MS = 600_000
"""An exposure that nobody lives to see."""


async def test_one_that_hangs_costs_a_fault_and_is_ended(
    producer: Path, fakes: FakeCameras
) -> None:
    async with camera(producer, tries=1, image_timeout_s=3.0) as eye:
        await eye.grab()
        library = fakes.opened(LEFT)
        fakes.inject(LEFT, "hang")
        with pytest.raises(ReplyTimeout, match="hangs"):
            await eye.grab()
        assert ended(library)
        fakes.inject(LEFT, "hang", 0)
        await eye.connect()
        await eye.grab()


async def test_one_that_crashes_costs_a_fault(producer: Path, fakes: FakeCameras) -> None:
    async with camera(producer) as eye:
        await eye.grab()
        fakes.inject(LEFT, "crash")
        with pytest.raises(LinkLost, match="crashed"):
            await eye.grab()
        await eye.grab()


async def test_one_that_dies_while_it_waits_for_an_image_costs_a_fault(
    producer: Path, fakes: FakeCameras
) -> None:
    async with camera(producer, image_timeout_s=60.0) as eye:
        library = fakes.opened(LEFT)
        assert library not in {0, os.getpid()}
        fakes.inject(LEFT, "slow_ms", NEVER_MS)
        waiting = asyncio.create_task(eye.grab())
        await until(lambda: fakes.begun(LEFT) == 1, within_s=60.0)
        os.kill(library, signal.SIGKILL)
        with pytest.raises(LinkLost, match="crashed"):
            await waiting
        fakes.inject(LEFT, "slow_ms", 0)
        await eye.grab()
        assert fakes.opened(LEFT) not in {0, library}


async def test_one_that_is_found_dead_is_started_anew_without_a_fault(
    producer: Path, fakes: FakeCameras
) -> None:
    """It had nothing to do when it died, so no image of the cell is lost with it."""
    async with camera(producer) as eye:
        library = fakes.opened(LEFT)
        os.kill(library, signal.SIGKILL)
        await until(lambda: told_its_parent(library), within_s=60.0)
        image = await eye.grab()
        assert fakes.opened(LEFT) not in {0, library}
    # The first image of a camera that was opened anew.
    assert image.pixels[0, 0] == 37


def told_its_parent(child: int) -> bool:
    """Whether a child of this process is gone with all of its threads; leaves it to be waited for.

    By /proc it is a zombie sooner, when its first thread has ended.
    """
    return os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None


BENCH = """name = "bench"
[cameras.eye]
driver = "gige"
settings.producers = ["{producer}"]
settings.camera.serial_number = "GL-1"
settings.image_timeout_s = 90.0
"""


def test_one_that_is_busy_ends_with_its_daemon(
    producer: Path, fakes: FakeCameras, tmp_path: Path
) -> None:
    """A camera that the library of a dead daemon keeps would be in use for the next one."""
    cell = tmp_path / "bench.toml"
    cell.write_text(BENCH.format(producer=producer))
    fakes.inject(LEFT, "slow_ms", NEVER_MS)
    program = "from cellctl.cli.app import main; main()"
    daemon = subprocess.Popen(
        [sys.executable, "-c", program, "grab", cell, "--camera", "eye", "--out", tmp_path / "out"],
    )
    try:
        # While it waits for an image it does not look whether anybody waits for the answer.
        until_blocking(lambda: fakes.begun(LEFT) == 1 or daemon.poll() is not None, within_s=60.0)
        library = fakes.opened(LEFT)
        assert library not in {0, os.getpid(), daemon.pid}
        assert not ended(library)
    finally:
        daemon.kill()
        daemon.wait()
    until_blocking(lambda: ended(library), within_s=60.0)


def test_it_loads_nothing_that_checks_a_cell_file() -> None:
    """It is started anew for every camera that was lost, and starts in half the time without."""
    code = "import drivers.camera.gige.library_process.child, sys; print(*sys.modules)"
    words = [sys.executable, "-c", code]
    loaded = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60).stdout
    assert "harvesters.core" in loaded.split()
    assert {"pydantic", "scipy", "cellctl.errors"}.isdisjoint(loaded.split())
