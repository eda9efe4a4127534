"""One power cut: a program that writes, the cut at a random moment, and what is left."""

import contextlib
import itertools
import multiprocessing
import random
import time
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

from benchmarks.power_cut.disk import Disk
from benchmarks.power_cut.writes import KINDS, Write
from cellctl.errors.base import CellError
from cellctl.errors.calibration import CalibrationNotStored
from cellctl.errors.records.store import RecordNotWritten, StoreUnavailable

_MOST_WRITES = 12
"""The cut comes after so many acknowledged writes at most, and then in the middle of one."""
_WRITER_S = 120.0
"""Long enough for a busy PC; a writer that is still silent then is broken."""

# Writers are copies of a process that has loaded everything and has one thread, which a copy of
# this one would not have.
_WRITERS = multiprocessing.get_context("forkserver")
_WRITERS.set_forkserver_preload(["benchmarks.power_cut.writes"])


@dataclass(frozen=True, slots=True)
class Outcome:
    """What one cut left."""

    kind: str
    acknowledged: int
    lost: tuple[str, ...]
    """Acknowledged writes that are not there any more."""
    problems: tuple[str, ...]
    """What the ledger finds wrong after the cut."""


def cut_while_writing(kind: str, folder: Path, chance: random.Random) -> Outcome:
    """Cut the power at a random moment of writes of one kind. Raises ``PowerNotCut``."""
    with Disk(folder) as disk:
        acknowledged = _write_and_cut(kind, disk, chance)
        disk.restart()
        return _looked_at(kind, disk.mount_point, acknowledged)


def _write_and_cut(kind: str, disk: Disk, chance: random.Random) -> list[str]:
    """Names of the writes that were acknowledged before the power went."""
    ours, theirs = _WRITERS.Pipe(duplex=False)
    writer = _WRITERS.Process(target=_write_on, args=(kind, disk.mount_point, theirs))
    writer.start()
    theirs.close()
    try:
        names = [_told(ours) for _ in range(chance.randint(0, _MOST_WRITES))]
        # Somewhere within the next write, whose steps take some milliseconds.
        time.sleep(chance.uniform(0.0, 0.02))
        # What is acknowledged later does not count: the kernel's shutdown is not done at once, and
        # a sync that is under way meanwhile may report success, for a plain file as well.
        while ours.poll():
            names.append(str(ours.recv()))
        disk.cut_power()
    finally:
        writer.kill()
        writer.join()
    return names


def _write_on(kind: str, folder: Path, acknowledged: Connection) -> None:
    """The writer: writes for ever and says each name once it is acknowledged."""
    # The errors of a disk that is gone; any other one is a mistake, and is shown.
    with contextlib.suppress(RecordNotWritten, StoreUnavailable, CalibrationNotStored, OSError):
        writes = KINDS[kind](folder)
        for count in itertools.count(1):
            acknowledged.send(writes.do(count))


def _told(acknowledged: Connection) -> str:
    if not acknowledged.poll(_WRITER_S):
        raise TimeoutError(f"the writer has acknowledged nothing for {_WRITER_S:g} s")
    return str(acknowledged.recv())


def _looked_at(kind: str, folder: Path, names: Sequence[str]) -> Outcome:
    found = KINDS[kind](folder)
    try:
        lost = tuple(name for name in names if not _is_there(found, name))
        return Outcome(kind, len(names), lost, tuple(found.store.verify()))
    finally:
        found.store.close()


def _is_there(found: Write, name: str) -> bool:
    try:
        return found.is_there(name)
    # Whatever keeps a record from being read, it is not there for whoever asks for it.
    except CellError:
        return False
