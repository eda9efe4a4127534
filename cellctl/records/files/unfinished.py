"""Recordings of runs that are still open: files that a daemon which dies leaves behind."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from cellctl.errors.records.store import RecordNotWritten
from cellctl.files.atomic_files import make_folder_durably

MOTION = "motion.mcap"
"""Name of a recording among the files of its run."""


class UnfinishedRecordings:
    """A folder with one file for each open run. Methods raise ``RecordNotWritten``.

    Not made durable: what a crash of the daemon leaves is in the memory of the kernel, and waiting
    for the disk twice a second would disturb what has to be stored.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def open(self, run: int) -> BinaryIO:
        """A new file for a run."""
        path = self._path(run)
        with _raising_not_written(path):
            make_folder_durably(self._folder)
            return path.open("wb")

    def read(self, run: int) -> bytes | None:
        """What the file of a run holds so far; None when there is none."""
        path = self._path(run)
        with _raising_not_written(path):
            return path.read_bytes() if path.exists() else None

    def remove(self, run: int) -> None:
        """Remove the recording of a run that has it in its record, or that will never have a
        record."""
        _remove(self._path(run))

    def clear(self) -> None:
        """Remove the files of all runs: no run is open."""
        for path in self._folder.glob("*.mcap"):
            _remove(path)

    def _path(self, run: int) -> Path:
        return self._folder / f"{run}.mcap"


def _remove(path: Path) -> None:
    with _raising_not_written(path):
        path.unlink(missing_ok=True)


@contextmanager
def _raising_not_written(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise RecordNotWritten(f"recording of run {path.stem}: {error.strerror}") from error
