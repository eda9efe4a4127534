"""A daemon that dies leaves what robots were told and sensors felt: the next one keeps it."""

import os
import signal
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

import pytest

from cellctl.errors.records.store import RecordNotWritten
from cellctl.records.entries import RunResult
from cellctl.records.files import motion_file
from cellctl.records.files.mcap_reading import read_mcap
from cellctl.records.files.unfinished import MOTION
from cellctl.records.store import RunStore
from tests.unit.records.conftest import start

# Moves until it is killed; says so once the first chunk has left the process.
DAEMON = """
import sys
from datetime import UTC, datetime
from pathlib import Path
import numpy as np
from cellctl.records.files.motion_file import MotionWriter
from cellctl.records.store import RunStore
from tests.unit.records.conftest import start

store = RunStore(Path(sys.argv[1]))
store.mark_interrupted()
run = start(store)
file = store.open_recording(run)
writer = MotionWriter(file, datetime.now(UTC), 0.0)
rng, at_s = np.random.default_rng(1), 0.0
while True:
    times_s = at_s + np.arange(100) / 1000
    writer.force("force", times_s, rng.normal(0.0, 10.0, (100, 6)))
    writer.flush()
    at_s += 0.1
    if file.tell() > 100_000:
        print(at_s, flush=True)
"""


def test_a_daemon_that_is_killed_leaves_its_force_curve(tmp_path: Path) -> None:
    command = [sys.executable, "-c", DAEMON, str(tmp_path / "store")]
    root = Path(__file__).parents[4]
    with subprocess.Popen(command, cwd=root, stdout=subprocess.PIPE, text=True) as daemon:
        assert daemon.stdout is not None
        felt_s = float(daemon.stdout.readline())
        daemon.send_signal(signal.SIGKILL)
    store = RunStore(tmp_path / "store")
    (run,) = store.mark_interrupted()
    record = store.run(run)
    assert record.head.result == RunResult.INTERRUPTED
    (artefact,) = record.artefacts
    content = read_mcap(store.artefacts.get(artefact.sha256))
    assert artefact.name == MOTION
    assert not content.complete
    # At most the chunk that was being filled is lost: half a second and what compresses well.
    assert len(content.messages) >= 1000 * (felt_s - 1.0)
    assert store.verify() == []
    store.close()
    assert list((tmp_path / "store" / "unfinished").iterdir()) == []


def test_what_was_kept_by_then_is_not_kept_twice(store: RunStore) -> None:
    """A daemon may die between storing a recording and removing its file."""
    store.mark_interrupted()
    run = start(store)
    with store.open_recording(run) as file:
        motion_file.MotionWriter(file, datetime.now(UTC), 0.0).finish()
    left = store.path / "unfinished" / f"{run}.mcap"
    data = left.read_bytes()
    store.keep_recording(run)
    assert not left.exists()
    store.close_run(run, RunResult.GOOD)
    left.write_bytes(data)
    assert store.mark_interrupted() == []
    assert len(store.run(run).artefacts) == 1
    assert not left.exists()


@pytest.mark.parametrize("content", [b"", b"\x89MCAP0\r\n", b"no recording"])
def test_a_file_without_a_message_is_no_recording(store: RunStore, content: bytes) -> None:
    store.mark_interrupted()
    run = start(store)
    with store.open_recording(run) as file:
        file.write(content)
    assert store.mark_interrupted() == [run]
    assert store.run(run).artefacts == ()


def test_a_folder_that_takes_no_file_is_a_fault_of_the_disk(store: RunStore) -> None:
    (store.path / "unfinished").write_text("in the way")
    with pytest.raises(RecordNotWritten, match="recording of run 1"):
        store.open_recording(1)


def test_a_run_without_a_recording_is_closed_without(store: RunStore) -> None:
    store.mark_interrupted()
    run = start(store)
    store.keep_recording(run)
    assert store.run(run).artefacts == ()
    assert os.listdir(store.path).count("unfinished") == 0
