"""The fake producer itself: under sanitizers, and without leaks over many openings."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fakes.gentl.build import build_producer
from fakes.gentl.cameras import ENVIRONMENT, FakeCameras
from tests.wire.gige.conftest import LEFT, camera

SESSION = """
import sys
from harvesters.core import Harvester
for _ in range(3):
    harvester = Harvester()
    harvester.add_file(sys.argv[1])
    harvester.update()
    cameras = [harvester.create({"serial_number": serial}) for serial in sys.argv[2:]]
    for camera in cameras:
        nodes = camera.remote_device.node_map
        nodes.TriggerMode.value = "On"
        nodes.TriggerSource.value = "Software"
        camera.start()
    for _ in range(20):
        for camera in cameras:
            camera.remote_device.node_map.TriggerSoftware.execute()
        for camera in cameras:
            with camera.fetch(timeout=5) as buffer:
                assert buffer.payload.components[0].data.size == 64 * 48
    for camera in cameras:
        camera.stop()
        camera.destroy()
    harvester.reset()
print("clean")
"""


@pytest.mark.long
def test_under_sanitizers(tmp_path: Path, fakes: FakeCameras) -> None:
    producer = build_producer(tmp_path, "-g", "-fsanitize=address,undefined")
    # The C++ library too: the sanitizer looks for its exceptions before Python loads anything.
    preloaded = " ".join(map(_library, ("libasan.so", "libstdc++.so.6")))
    session = subprocess.run(
        [sys.executable, "-c", SESSION, str(producer), "GL-1", "GR-2"],
        capture_output=True,
        text=True,
        check=False,
        timeout=200,
        # Leaks are those of Python and of the standard's libraries: only the producer is looked at.
        env=os.environ
        | {
            "LD_PRELOAD": preloaded,
            "ASAN_OPTIONS": "detect_leaks=0",
            "UBSAN_OPTIONS": "halt_on_error=1",
            ENVIRONMENT: str(fakes.path),
        },
    )
    assert session.stdout.endswith("clean\n"), session.stderr
    assert "ERROR: AddressSanitizer" not in session.stderr
    assert "runtime error" not in session.stderr


def _library(name: str) -> str:
    found = subprocess.run(
        ["cc", f"-print-file-name={name}"], capture_output=True, text=True, check=True
    )
    return found.stdout.strip()


@pytest.mark.long
async def test_many_openings_leave_nothing(producer: Path, fakes: FakeCameras) -> None:
    """Fifty: each of them starts a process, and the descriptors of one are those of all."""
    async with camera(producer) as eye:
        await eye.grab()
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(50):
        async with camera(producer) as eye:
            await eye.grab()
    assert len(os.listdir("/proc/self/fd")) <= before
    assert (fakes.opened(LEFT), fakes.buffers(LEFT)) == (0, 0)


@pytest.mark.long
async def test_many_images_leave_nothing(producer: Path, fakes: FakeCameras) -> None:
    async with camera(producer) as eye:
        child = 0
        for number in range(2000):
            await eye.grab()
            if number == 200:
                child = fakes.opened(LEFT)
                before = _kept(child)
        after = _kept(child)
    assert after[0] <= before[0], "descriptors of the library's process"
    assert after[1] <= before[1] + 2000, "its memory, kB"


def _kept(process: int) -> tuple[int, int]:
    """Open descriptors and resident memory (kB)."""
    status = Path(f"/proc/{process}/status").read_text(encoding="ascii")
    memory = next(line for line in status.splitlines() if line.startswith("VmRSS"))
    return len(os.listdir(f"/proc/{process}/fd")), int(memory.split()[1])
