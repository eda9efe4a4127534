"""The fake producer itself: under sanitizers, and without leaks over many openings."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from drivers.camera.gige.driver import GigeCamera
from fakes.gentl.build import build_producer
from fakes.gentl.cameras import FakeCameras
from tests.wire.gige.conftest import LEFT, camera, descriptors

INJECTED = ("incomplete or not available", "already in use")
"""What harvesters warns of where a fault was injected."""


def session(producer: Path, what: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """`producer_session`, or `cell_session` for "cell", in a process of its own."""
    module = "cell_session" if what == "cell" else "producer_session"
    return subprocess.run(
        [sys.executable, "-m", f"tests.wire.gige.{module}", str(producer), what],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        env=os.environ | environment,
    )


def test_harvesters_has_nothing_to_warn_of(producer: Path) -> None:
    done = session(producer, "good")
    assert (done.stdout, done.stderr) == ("clean\n", "")


@pytest.mark.parametrize("what", ["faults", "loss"])
def test_faults_leave_the_producer_usable(producer: Path, what: str) -> None:
    done = session(producer, what)
    assert done.stdout == "clean\n", done.stderr
    # It warns of what was injected, and of nothing that the producer would lack.
    warned = [line for line in done.stderr.splitlines() if " :: WARNING :: " in line]
    assert all(any(said in line for said in INJECTED) for line in warned), done.stderr


def test_the_command_of_make_builds_it(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "fakes.gentl.build", str(tmp_path)]
    built = subprocess.run(command, capture_output=True, text=True, check=True)
    path = Path(built.stdout.strip())
    assert path.parent == tmp_path
    assert session(path, "good").stdout == "clean\n"
    recipe = (Path(__file__).parents[3] / "Makefile").read_text(encoding="utf-8")
    assert "\nproducer: venv\n\t$(BIN)/python -m fakes.gentl.build $(FOLDER)\n" in recipe


@pytest.mark.long
@pytest.mark.parametrize(
    ("what", "options"),
    [
        ("good", ()),
        ("good", ("-DLINE_PADDING=12", "-DTICKS_PER_S=125000000")),
        ("faults", ()),
        ("loss", ()),
        ("cell", ()),
    ],
)
def test_under_sanitizers(tmp_path: Path, what: str, options: tuple[str, ...]) -> None:
    producer = build_producer(tmp_path, "-g", "-fsanitize=address,undefined", *options)
    # The C++ library too: the sanitizer looks for its exceptions before Python loads anything.
    preloaded = " ".join(map(_library, ("libasan.so", "libstdc++.so.6")))
    done = session(
        producer,
        what,
        LD_PRELOAD=preloaded,
        # Leaks are those of Python and of the standard's libraries, and genicam mixes new[] with
        # delete in its events: only the producer is looked at, which is in C and knows neither.
        ASAN_OPTIONS="detect_leaks=0:alloc_dealloc_mismatch=0",
        UBSAN_OPTIONS="halt_on_error=1",
    )
    assert done.stdout.endswith("clean\n"), done.stderr
    assert "ERROR: AddressSanitizer" not in done.stderr
    assert "runtime error" not in done.stderr


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
                before = await _kept(eye, child)
        after = await _kept(eye, child)
    assert after[0] <= before[0], "descriptors of the library's process"
    assert after[1] <= before[1] + 2000, "its memory, kB"


async def _kept(eye: GigeCamera, process: int) -> tuple[int, int]:
    """Open descriptors and resident memory (kB)."""
    return await descriptors(eye, process), _resident_kb(process)


def _resident_kb(process: int) -> int:
    status = Path(f"/proc/{process}/status").read_text(encoding="ascii")
    memory = next(line for line in status.splitlines() if line.startswith("VmRSS"))
    return int(memory.split()[1])
