"""Only a test that failed while the machine stood still is tried again."""

import subprocess
import sys
from pathlib import Path

PAUSED = """
import os, signal, socket, subprocess, sys
from pathlib import Path

TRIED = Path(__file__).with_name("tried")

def test_that_fails_at_first(shared):
    if TRIED.exists():
        return
    TRIED.touch()
    left_open = socket.socket()
    waker = f"import os, signal, time; time.sleep(0.5); os.kill({os.getpid()}, signal.SIGCONT)"
    with subprocess.Popen([sys.executable, "-c", waker]):
        os.kill(os.getpid(), signal.SIGSTOP)
    assert False, "the first try"

import pytest

@pytest.fixture(scope="module")
def shared():
    return 1
"""

BUSY = """
import time
from pathlib import Path

def test_that_fails():
    with Path(__file__).with_name("tries").open("a") as tries:
        tries.write("x")
    until_s = time.process_time() + 0.3
    while time.process_time() < until_s:
        pass
    assert False, "for a reason of its own"
"""


def outcome_of(test: str, folder: Path) -> subprocess.CompletedProcess[str]:
    (folder / "test_it.py").write_text(test)
    command = [sys.executable, "-m", "pytest", "-p", "tests.machine_pauses", "-c", "/dev/null"]
    # As in this project: what a test leaves open is an error.
    command += [
        "-W",
        "error::ResourceWarning",
        "-W",
        "error::pytest.PytestUnraisableExceptionWarning",
    ]
    return subprocess.run(
        [*command, "--rootdir", str(folder), str(folder / "test_it.py")],
        check=False,
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
    )


def test_a_failure_in_a_pause_is_tried_again_and_named(tmp_path: Path) -> None:
    outcome = outcome_of(PAUSED, tmp_path)
    assert outcome.returncode == 0, outcome.stdout
    assert "TRIED AGAIN" in outcome.stdout
    assert "1 passed" in outcome.stdout


def test_a_failure_without_a_pause_counts(tmp_path: Path) -> None:
    outcome = outcome_of(BUSY, tmp_path)
    assert outcome.returncode == 1, outcome.stdout
    assert "1 failed" in outcome.stdout
    if "TRIED AGAIN" not in outcome.stdout:  # the machine may truly have stood still
        assert (tmp_path / "tries").read_text() == "x"
