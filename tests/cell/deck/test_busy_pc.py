"""On a computer that has too much to do, the demonstration ends good or names the cause."""

import subprocess
import sys
from collections.abc import Iterator

import pytest

from tests.rigs.whole_cell.own_cell import OwnCell

pytestmark = [pytest.mark.long, pytest.mark.timeout(900)]

BUSY = 14
"""Programs beside the demonstration that never wait: load 14 on two processors."""


@pytest.fixture
def busy() -> Iterator[None]:
    """Other people's programs, at the priority that programs have by default."""
    others = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(BUSY)]
    yield
    for other in others:
        other.kill()
        other.wait()


@pytest.mark.usefixtures("busy")
def test_a_part_beside_many_busy_programs(own: OwnCell) -> None:
    demo = own.demo(own.folder / "run")
    code = demo.end(840)
    assert "images come through a GenTL producer" in demo.stdout
    assert (code == 0 and "seed 1: good" in demo.stdout) or (
        code == 2 and "this computer was too slow" in demo.stderr
    ), demo.stdout + demo.stderr
