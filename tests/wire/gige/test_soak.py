"""`make soak-cameras`, a few times each, and the scales that its figures are weighed on."""

import os
import subprocess
import sys

import pytest

from tests.rigs.kept import Kept, kept


@pytest.mark.figures
def test_a_short_soak() -> None:
    # It runs in a process of its own: that of the tests keeps what other tests have not let go.
    times = ["--cycles", "5", "--pulls", "5", "--grabs", "100"]
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.cameras.soak", *times],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"COLUMNS": "160"},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    for job in ("open, grab, close", "cable pulls", "images"):
        assert any(job in line and "flat" in line for line in done.stdout.splitlines()), job


def test_what_is_kept_is_seen() -> None:
    before = kept(os.getpid())
    descriptor = os.open("/dev/null", os.O_RDONLY)
    after = kept(os.getpid())
    os.close(descriptor)
    assert after.outgrows(before)
    assert not before.outgrows(before)
    assert Kept(1, 1, 50_000).outgrows(Kept(1, 1, 1_000))
    assert Kept(1, 3, 1_000).outgrows(Kept(1, 1, 1_000))
