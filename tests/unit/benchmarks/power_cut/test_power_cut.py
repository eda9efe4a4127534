"""A power cut loses nothing that was acknowledged; and the cut is one, for it loses the rest."""

import random
from pathlib import Path

import pytest

from benchmarks.power_cut.cut import cut_while_writing
from benchmarks.power_cut.disk import Disk, PowerNotCut
from benchmarks.power_cut.writes import KINDS


@pytest.fixture
def disk_folder(tmp_path: Path) -> Path:
    """A folder for a disk, on a machine that lets us cut its power."""
    try:
        with Disk(tmp_path / "trial") as disk:
            disk.cut_power()
    except PowerNotCut as error:
        pytest.skip(f"no power can be cut here: {error}")
    return tmp_path / "cut"


def test_what_nobody_brought_to_the_disk_is_lost(disk_folder: Path) -> None:
    with Disk(disk_folder) as disk:
        (disk.mount_point / "unsynced").write_bytes(b"data")
        disk.cut_power()
        disk.restart()
        assert not (disk.mount_point / "unsynced").exists()


@pytest.mark.parametrize("kind", KINDS)
def test_what_was_acknowledged_is_there_after_a_power_cut(kind: str, disk_folder: Path) -> None:
    outcome = cut_while_writing(kind, disk_folder, random.Random(kind))
    assert outcome.lost == ()
    assert outcome.problems == ()
